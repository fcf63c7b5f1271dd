#include "core/scan/deskew.hpp"

#include <algorithm>

#include "core/geometry/so3.hpp"
#include "core/inertial/propagation.hpp"

namespace slamd::scan {

using geometry::Se3;
using inertial::NavState;

namespace {

constexpr auto kStep_ns = static_cast<std::uint32_t>(ScanMotion::kGridStep.count());

/// Moves a state to `to` with the mean of the inertial samples, or at constant velocity without any.
/// `next` is the index of the first sample after the state's stamp; it advances.
void advance(NavState& state, std::span<const sensor::ImuSample> samples, std::size_t& next, Stamp to) {
  while (state.stamp < to) {
    while (next < samples.size() && samples[next].stamp <= state.stamp) {
      ++next;
    }
    const bool between = next > 0 && next < samples.size();
    const Stamp piece_end = between ? std::min(samples[next].stamp, to) : to;
    const double dt_s = to_seconds(piece_end - state.stamp);
    if (samples.empty()) {
      state.T_odom_imu.translation() += state.v_odom_imu * dt_s;
      state.T_odom_imu.rotation() = state.T_odom_imu.rotation() * geometry::so3_exp(-state.gyro_bias * dt_s);
    } else {
      const sensor::ImuSample& before = samples[next == 0 ? 0 : next - 1];
      const sensor::ImuSample& after = samples[std::min(next, samples.size() - 1)];
      const Stamp middle = state.stamp + (piece_end - state.stamp) / 2;
      inertial::propagate_mean(state, inertial::interpolate(before, after, middle), dt_s);
    }
    state.stamp = piece_end;
  }
}

}  // namespace

ScanMotion::ScanMotion(Duration longest_scan)
    : T_odom_grid_(static_cast<std::size_t>(longest_scan / kGridStep) + 2),
      T_end_grid_(static_cast<std::size_t>(longest_scan / kGridStep) + 2) {}

void ScanMotion::set_still(Stamp begin, Stamp end) {
  begin_ = begin;
  end_ = end;
  T_end_grid_.clear();
  for (int i = 0; i < 2; ++i) {
    T_end_grid_.push_back({Eigen::Matrix3f::Identity(), Eigen::Vector3f::Zero()});
  }
}

void ScanMotion::predict(const NavState& earlier,
                         std::span<const sensor::ImuSample> samples,
                         Stamp begin,
                         Stamp end) {
  begin_ = begin;
  end_ = std::min(end, begin + kGridStep * static_cast<std::int64_t>(T_odom_grid_.capacity() - 2));
  NavState state = earlier;
  std::size_t next = 0;
  T_odom_grid_.clear();
  for (Stamp now = begin_;; now += kGridStep) {
    advance(state, samples, next, now);
    T_odom_grid_.push_back(state.T_odom_imu);
    if (now >= end_) {
      break;
    }
  }
  // The last grid pose may lie up to a step after the end; interpolate the end itself.
  const std::size_t last = T_odom_grid_.size() - 1;
  const double ratio =
      last == 0 ? 0.0 : to_seconds(end_ - begin_) / to_seconds(kGridStep) - static_cast<double>(last - 1);
  const Se3 T_odom_end =
      last == 0 ? T_odom_grid_[0] : geometry::interpolate(T_odom_grid_[last - 1], T_odom_grid_[last], ratio);
  const Se3 T_end_odom = T_odom_end.inverse();
  T_end_grid_.clear();
  for (const Se3& T_odom_t : T_odom_grid_) {
    const Se3 T_end_t = T_end_odom * T_odom_t;
    T_end_grid_.push_back({T_end_t.rotation().cast<float>(), T_end_t.translation().cast<float>()});
  }
  if (T_end_grid_.size() == 1) {
    T_end_grid_.push_back(T_end_grid_[0]);
  }
}

Eigen::Vector3f ScanMotion::to_end(const Eigen::Vector3f& p_imu, std::uint32_t offset_ns) const {
  const std::size_t i = std::min<std::size_t>(offset_ns / kStep_ns, T_end_grid_.size() - 2);
  // Within a millisecond a vehicle turns by milliradians: blending the two results is exact to micrometres.
  const float ratio =
      static_cast<float>(offset_ns - i * kStep_ns) / static_cast<float>(kStep_ns);
  const GridPose& a = T_end_grid_[i];
  const GridPose& b = T_end_grid_[i + 1];
  const Eigen::Vector3f p_a = a.R * p_imu + a.t;
  const Eigen::Vector3f p_b = b.R * p_imu + b.t;
  return p_a + std::min(ratio, 1.0F) * (p_b - p_a);
}

double ScanMotion::turned_rad() const {
  return T_end_grid_.empty() ? 0.0 : geometry::so3_log(T_end_grid_[0].R.cast<double>()).norm();
}

double ScanMotion::moved_m() const { return T_end_grid_.empty() ? 0.0 : T_end_grid_[0].t.norm(); }

}  // namespace slamd::scan
