#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace slamd::bench {

/// The nearest stored points of a query by distance, nearest first; only those within the radius. Units: m².
struct Found {
  static constexpr std::size_t kMax = 5;

  std::size_t count = 0;
  std::array<float, kMax> distance_sq_m2{};
};

/// A structure of another library that is built anew for each scan.
class NeighbourPeer {
 public:
  virtual ~NeighbourPeer() = default;

  virtual std::string name() const = 0;

  /// Takes the stored points over, in the library's own form: not part of its time.
  virtual void take(std::span<const Eigen::Vector3f> points) = 0;

  /// Builds the structure over them.
  virtual void build() = 0;

  /// Answers all queries: k = Found::kMax, cut at the radius.
  virtual void search(std::span<const Eigen::Vector3f> queries, float radius_m, std::span<Found> out) = 0;
};

/// PCL's KdTreeFLANN and nanoflann; none where slamd-bench was built without them.
std::vector<std::unique_ptr<NeighbourPeer>> neighbour_peers();

}  // namespace slamd::bench
