#pragma once

#include "core/odometry/odometry_config.hpp"
#include "tools/study/estimator.hpp"

namespace slamd::study {

/// The iterated EKF from the prediction: the product's `odometry.filter = "iekf"`.
/// Source: x = argmin ‖x ⊟ x⁻‖²_P⁻¹ + Σ w r² by Gauss–Newton (Bell and Cathey, 1993; Xu et al.,
/// 2022).
class Ekf : public Estimator {
 public:
  explicit Ekf(const odometry::OdometryConfig& config);

  odometry::UpdateResult update(const Task& task) override;

 private:
  odometry::UpdateConfig config_;
  registration::Association association_;
};

/// The coarse-to-fine EKF: thirty Gauss–Newton iterations without a prior, the first half on cells
/// of three times the side, with a gate that shrinks from 2 m to 0.3 m; then the EKF's update,
/// linearised there. Source: design.md, "What is known so far"; the alignment is the one that the
/// product's recovery tries as well. Where it ends beside the prediction, the plain EKF is all that
/// is needed; where the prior excludes it, the prior was wrong and is widened: both as the product
/// does for its swarm's modes.
class CoarseToFineEkf : public Estimator {
 public:
  explicit CoarseToFineEkf(const odometry::OdometryConfig& config);

  odometry::UpdateResult update(const Task& task) override;

 private:
  odometry::UpdateConfig config_;
  psf::PsfConfig psf_;
  registration::Association association_;
};

}  // namespace slamd::study
