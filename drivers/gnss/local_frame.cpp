#include "drivers/gnss/local_frame.hpp"

#include "core/base/assert.hpp"

namespace slamd::gnss {

std::optional<Eigen::Vector3d> LocalFrame::enu_of(const sensor::GnssFix& fix) {
  if (!fix.is_good() || (!origin_ && !fix.altitude_m)) {
    return std::nullopt;
  }
  if (!origin_) {
    origin_ = Geodetic{fix.latitude_deg, fix.longitude_deg, *fix.altitude_m};
    around_.Reset(origin_->latitude_deg, origin_->longitude_deg, origin_->altitude_m);
  }
  Eigen::Vector3d p_enu;
  around_.Forward(fix.latitude_deg, fix.longitude_deg, fix.altitude_m.value_or(origin_->altitude_m), p_enu.x(), p_enu.y(), p_enu.z());
  return p_enu;
}

LocalFrame::Geodetic LocalFrame::geodetic_of(const Eigen::Vector3d& p_enu) const {
  SLAMD_ASSERT(origin_.has_value());
  Geodetic place;
  around_.Reverse(p_enu.x(), p_enu.y(), p_enu.z(), place.latitude_deg, place.longitude_deg, place.altitude_m);
  return place;
}

}  // namespace slamd::gnss
