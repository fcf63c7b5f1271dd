#include "tools/bench/neighbour_peers.hpp"

#include <nanoflann.hpp>
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>

namespace slamd::bench {

namespace {

/// LIO-SAM's way: nearestKSearch, and what lies beyond the radius is left out afterwards.
class PclTree : public NeighbourPeer {
 public:
  std::string name() const override { return "PCL KdTreeFLANN"; }

  void take(std::span<const Eigen::Vector3f> points) override {
    cloud_->clear();
    for (const Eigen::Vector3f& p : points) {
      cloud_->push_back({p.x(), p.y(), p.z()});
    }
  }

  void build() override { tree_.setInputCloud(cloud_); }

  void search(std::span<const Eigen::Vector3f> queries, float radius_m, std::span<Found> out) override {
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const pcl::PointXYZ query(queries[i].x(), queries[i].y(), queries[i].z());
      const int found = tree_.nearestKSearch(query, Found::kMax, indices_, distance_sq_m2_);
      out[i].count = 0;
      for (int k = 0; k < found && distance_sq_m2_[static_cast<std::size_t>(k)] < radius_m * radius_m; ++k) {
        out[i].distance_sq_m2[out[i].count++] = distance_sq_m2_[static_cast<std::size_t>(k)];
      }
    }
  }

 private:
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud_{new pcl::PointCloud<pcl::PointXYZ>};
  pcl::KdTreeFLANN<pcl::PointXYZ> tree_;
  pcl::Indices indices_;
  std::vector<float> distance_sq_m2_;
};

/// What nanoflann asks of a cloud.
struct Cloud {
  std::vector<Eigen::Vector3f> points;

  std::size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i][static_cast<Eigen::Index>(axis)]; }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

class NanoflannTree : public NeighbourPeer {
 public:
  std::string name() const override { return "nanoflann"; }

  void take(std::span<const Eigen::Vector3f> points) override { cloud_.points.assign(points.begin(), points.end()); }

  void build() override { tree_ = std::make_unique<Tree>(3, cloud_, nanoflann::KDTreeSingleIndexAdaptorParams(10)); }

  void search(std::span<const Eigen::Vector3f> queries, float radius_m, std::span<Found> out) override {
    std::array<std::uint32_t, Found::kMax> indices{};
    for (std::size_t i = 0; i < queries.size(); ++i) {
      const std::size_t found =
          tree_->knnSearch(queries[i].data(), Found::kMax, indices.data(), out[i].distance_sq_m2.data());
      out[i].count = 0;
      while (out[i].count < found && out[i].distance_sq_m2[out[i].count] < radius_m * radius_m) {
        ++out[i].count;
      }
    }
  }

 private:
  using Tree =
      nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3, std::uint32_t>;

  Cloud cloud_;
  std::unique_ptr<Tree> tree_;
};

}  // namespace

std::vector<std::unique_ptr<NeighbourPeer>> neighbour_peers() {
  std::vector<std::unique_ptr<NeighbourPeer>> peers;
  peers.push_back(std::make_unique<PclTree>());
  peers.push_back(std::make_unique<NanoflannTree>());
  return peers;
}

}  // namespace slamd::bench
