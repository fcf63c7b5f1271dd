#include "tools/status/json.hpp"

#include <nlohmann/json.hpp>

namespace slamd::status {

namespace {

using Json = nlohmann::ordered_json;

Json transform(const geometry::Se3& T) {
  const Eigen::Vector3d& p = T.translation();
  const Eigen::Quaterniond q = T.quaternion();
  return {{"position_m", {p.x(), p.y(), p.z()}}, {"quaternion_xyzw", {q.x(), q.y(), q.z(), q.w()}}};
}

template <typename Vector>
Json list(const Vector& v) {
  Json result = Json::array();
  for (const double value : v) {
    result.push_back(value);
  }
  return result;
}

Json of(const bus::Pose& pose) {
  return {{"stamp_ns", pose.stamp.time_since_epoch().count()},
          {"age_ns", pose.age.count()},
          {"T_odom_base", transform(pose.T_odom_base)},
          {"velocity_odom_mps", list(pose.v_odom_base)},
          {"rate_base_radps", list(pose.rate_base_radps)},
          {"std", list(pose.P_odom_base.diagonal().cwiseMax(0.0).cwiseSqrt().eval())},
          {"reset_counter", pose.reset_counter},
          {"correction_id", pose.correction_id},
          {"state", name_of(pose.state)},
          {"cause", name_of(pose.cause)},
          {"weak_axes", pose.weak_axes}};
}

Json of(const bus::MapToOdom& map_to_odom) {
  return {{"stamp_ns", map_to_odom.stamp.time_since_epoch().count()},
          {"T_map_odom", transform(map_to_odom.T_map_odom)},
          {"correction_id", map_to_odom.correction_id},
          {"cause", name_of(map_to_odom.cause)}};
}

Json of(const bus::Health& health) {
  Json result{{"stamp_ns", health.stamp.time_since_epoch().count()},
              {"uptime_ns", health.uptime.count()},
              {"state", name_of(health.state)},
              {"causes", Json::array()},
              {"weak_axes", health.weak_axes},
              {"swarm_use", health.swarm_use},
              {"particles", health.particles},
              {"inlier_share", health.inlier_share},
              {"imu_offset_ms", health.imu_offset_std_ms > 0.0F ? Json(health.imu_offset_ms) : Json(nullptr)},
              {"imu_offset_std_ms", health.imu_offset_std_ms > 0.0F ? Json(health.imu_offset_std_ms) : Json(nullptr)},
              {"sensors", Json::array()},
              {"stages", Json::array()},
              {"pools", Json::array()},
              {"counters", Json::object()}};
  for (const auto& cause : health.causes) {
    result["causes"].push_back(cause.view());
  }
  for (const auto& s : health.sensors) {
    result["sensors"].push_back({{"name", s.name.view()},
                                 {"state", name_of(s.state)},
                                 {"time", name_of(s.time)},
                                 {"rate_hz", s.rate_hz},
                                 {"received", s.received},
                                 {"lost", s.lost},
                                 {"dropped", s.dropped},
                                 {"time_residual_us", s.time_residual_us},
                                 {"time_skew_ppm", s.time_skew_ppm},
                                 {"time_steps", s.time_steps}});
  }
  for (const auto& s : health.stages) {
    result["stages"].push_back({{"name", s.name.view()},
                                {"p50_us", s.p50_us},
                                {"p99_us", s.p99_us},
                                {"max_us", s.max_us},
                                {"count", s.count}});
  }
  for (const auto& p : health.pools) {
    result["pools"].push_back({{"name", p.name.view()}, {"capacity", p.capacity}, {"low_water", p.low_water}});
  }
  for (const auto& c : health.counters) {
    result["counters"][std::string(c.name.view())] = c.value;
  }
  return result;
}

template <typename Message>
Json newest(const Heard::Newest<Message>& newest, Clock::time_point now) {
  if (!newest.message) {
    return nullptr;
  }
  Json result = of(*newest.message);
  result["heard_ago_s"] = to_seconds(now - newest.when);
  result["heard_count"] = newest.count;
  return result;
}

}  // namespace

std::string to_json(const Heard& heard, Clock::time_point now) {
  const Json result{{"health", newest(heard.health, now)},
                    {"pose", newest(heard.pose, now)},
                    {"map_to_odom", newest(heard.map_to_odom, now)},
                    {"pose_rate_hz", heard.pose_rate_hz},
                    {"scans", heard.scans},
                    {"scans_incomplete", heard.scans_incomplete},
                    {"malformed", heard.malformed}};
  // What others send need not be UTF-8.
  return result.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace slamd::status
