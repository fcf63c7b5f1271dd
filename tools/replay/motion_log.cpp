#include "tools/replay/motion_log.hpp"

#include "tools/replay/covariance_columns.hpp"

namespace slamd::replay {

void MotionLog::add(Stamp stamp, const odometry::MotionStep& step) {
  path_m_ += any_ ? (step.T_odom_base.translation() - T_odom_last_.translation()).norm() : 0.0;
  T_odom_last_ = step.T_odom_base;
  for (Begun& begun : begun_) {
    begun.covariance.add(step);
  }
  while (!begun_.empty() && path_m_ - begun_.front().path_m >= kLength_m) {
    claims_.push_back({begun_.front().stamp, stamp, begun_.front().covariance.covariance()});
    begun_.pop_front();
  }
  if (!any_ || begun_.empty() || path_m_ - begun_.back().path_m >= kSpacing_m) {
    begun_.push_back({stamp, path_m_, odometry::MotionCovariance(step)});
  }
  any_ = true;
}

void write_motions(std::FILE* file, const std::vector<evaluation::MotionClaim>& claims) {
  std::fputs("timestamp_ns,since_ns", file);
  write_covariance_names(file);
  std::fputc('\n', file);
  for (const evaluation::MotionClaim& claim : claims) {
    std::fprintf(file, "%lld,%lld", static_cast<long long>(claim.last.time_since_epoch().count()),
                 static_cast<long long>((claim.last - claim.first).count()));
    write_covariance(file, claim.covariance);
    std::fputc('\n', file);
  }
}

}  // namespace slamd::replay
