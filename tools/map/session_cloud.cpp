#include "tools/map/session_cloud.hpp"

#include <algorithm>
#include <optional>

#include "core/scan/voxel_sampler.hpp"

namespace slamd::map {

using geometry::Se3;

Se3 T_map_level(const storage::Session& session, std::size_t keyframe) {
  return session.T_map_base[keyframe] * Se3(session.keyframes[keyframe].R_base_level, Eigen::Vector3d::Zero());
}

std::vector<Eigen::Vector3f> cloud_of(const storage::Session& session, float spacing_m, const Share& share) {
  std::size_t all = 0;
  for (const storage::SessionKeyframe& keyframe : session.keyframes) {
    all += keyframe.cloud_level.size();
  }
  std::optional<scan::VoxelSampler> sampler;
  if (spacing_m > 0.0F) {
    sampler.emplace(std::max<std::size_t>(1, all));
    sampler->reset(spacing_m, std::max<std::size_t>(1, all));
  }
  std::vector<Eigen::Vector3f> points;
  for (std::size_t i = 0; i < session.keyframes.size(); ++i) {
    const Se3 T = T_map_level(session, i);
    const Eigen::Matrix3f R = T.rotation().cast<float>();
    const Eigen::Vector3f t = T.translation().cast<float>();
    for (const Eigen::Vector3f& p_level : session.keyframes[i].cloud_level) {
      const Eigen::Vector3f p = R * p_level + t;
      if (!sampler || sampler->admit(p)) {
        points.push_back(p);
      }
    }
    if (share) {
      share(static_cast<double>(i + 1) / static_cast<double>(session.keyframes.size()));
    }
  }
  return points;
}

std::vector<Eigen::Vector3f> way_of(const storage::Session& session) {
  std::vector<Eigen::Vector3f> way;
  for (const Se3& T : session.T_map_base) {
    way.push_back(T.translation().cast<float>());
  }
  return way;
}

}  // namespace slamd::map
