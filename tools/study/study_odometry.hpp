#pragma once

#include "core/odometry/odometry.hpp"
#include "tools/study/estimator.hpp"

namespace slamd::study {

/// The product's odometry with another estimator in it: prediction, judgement, confirmation and map
/// stay the same. Copies are forks: each goes on for itself.
class StudyOdometry : public odometry::Odometry {
 public:
  explicit StudyOdometry(const odometry::OdometryConfig& config);

  /// Takes an estimator, or the product's own for nullptr. `seed` is the estimator's.
  void use(Estimator* estimator, std::uint64_t seed);

  /// Makes the pose wrong, and the covariance larger by what is told of it.
  void disturb(const geometry::Vector6d& error, const inertial::Covariance& told);

  /// Lays a scan on the map from a given prior, and forgets that it did.
  odometry::UpdateResult registered(const scan::DeskewedScan& scan,
                                    const inertial::NavState& prior,
                                    const inertial::Covariance& P_prior);

 protected:
  odometry::UpdateResult update(const scan::DeskewedScan& scan,
                                odometry::Cause prediction_cause,
                                psf::Answer& swarm) override;

 private:
  std::size_t points_;
  Estimator* estimator_ = nullptr;
  std::uint64_t seed_ = 0;
};

}  // namespace slamd::study
