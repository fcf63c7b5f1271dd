#include "daemon/stages/front_end.hpp"

namespace slamd::stages {

FrontEnd::FrontEnd(const odometry::OdometryConfig& config)
    : preprocess_(config), odometry_(config), preprocessed_(config) {}

std::optional<odometry::OdometryResult> FrontEnd::process(const sensor::Scan& scan) {
  if (!preprocess_.process(scan, preprocessed_)) {
    return std::nullopt;
  }
  const double begin_ms = thread_cpu_ms();
  const odometry::OdometryResult result = odometry_.process(preprocessed_);
  times_ = {preprocessed_.preprocess_ms, thread_cpu_ms() - begin_ms};
  preprocess_.add_feedback(odometry_.feedback());
  return result;
}

std::optional<odometry::OdometryResult> FrontEnd::go_on_without_scan() {
  if (!preprocess_.go_on_without_scan(preprocessed_)) {
    return std::nullopt;
  }
  const odometry::OdometryResult result = odometry_.go_on_without_scan(preprocessed_);
  preprocess_.add_feedback(odometry_.feedback());
  return result;
}

}  // namespace slamd::stages
