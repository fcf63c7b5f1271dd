#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "drivers/storage/session_reader.hpp"

namespace slamd::map {

/// Told the share that is done.
using Share = std::function<void(double)>;

/// Returns where a keyframe's cloud lies in map: T_map_level, level being base's origin and heading with z up.
geometry::Se3 T_map_level(const storage::Session& session, std::size_t keyframe);

/// Returns the clouds of all keyframes in map, one point in a cube of this side; 0: all points.  Units: m.
std::vector<Eigen::Vector3f> cloud_of(const storage::Session& session, float spacing_m, const Share& share = {});

/// Returns the way: where each keyframe's base is in map.
std::vector<Eigen::Vector3f> way_of(const storage::Session& session);

}  // namespace slamd::map
