#pragma once

#include <array>
#include <vector>

#include "core/geometry/se3.hpp"

namespace slamd::simulate {

/// How a body moves at one moment.
/// Frames: pose, velocity and acceleration of base in world; rate in base.  Units: m, s, rad.
struct MotionState {
  geometry::Se3 T_world_base;
  Eigen::Vector3d velocity_mps;
  Eigen::Vector3d acceleration_mps2;
  Eigen::Vector3d rate_base_radps;
};

/// A shaking of the body: a sum of sines, each in all six channels of Motion.
struct Vibration {
  struct Mode {
    double rate_radps = 0.0;
    double phase_rad = 0.0;
    std::array<double, 6> amplitude{};
  };
  std::array<Mode, 5> modes{};
};

/// A motion with continuous jerk: a uniform quintic B-spline over x, y, z, yaw, pitch and roll, so that positions,
/// velocities, accelerations and turn rates are exact derivatives of one another.
class Motion {
 public:
  using Channels = std::array<double, 6>;  // x, y, z, yaw, pitch, roll

  /// Time between the control points of vehicles.
  static constexpr double kKnot_s = 0.05;

  /// Control points, one each `knot_s` seconds; the first and the last should stand still.
  Motion(std::vector<Channels> control_points, double knot_s);

  /// Adds a vibration of varying strength: `strength` has a control point for each of the motion.
  void vibrate(const Vibration& vibration, std::vector<double> strength);

  /// Goes on to another control point, with its strength of vibration; nobody may look at the motion meanwhile.
  /// What it was up to its old duration stays as it is.
  void append(const Channels& control_point, double strength);

  /// Valid from 0 to duration_s.
  MotionState at(double t_s) const;

  /// The pose alone, for ray casting.
  geometry::Se3 pose_at(double t_s) const;

  double duration_s() const { return duration_s_; }

 private:
  void evaluate(double t_s, int derivatives, Channels (&out)[3]) const;
  void add_vibration(double t_s, int derivatives, const double (&strength)[3], Channels (&out)[3]) const;

  std::vector<Channels> points_;
  std::vector<double> strength_;  // empty: no vibration
  Vibration vibration_;
  double knot_s_;
  double duration_s_;
};

/// The pose for some tens of microseconds after a moment: as exact as single firings need it, and quick.
class ShortMotion {
 public:
  ShortMotion(const Motion& motion, double t_s);

  /// Errors: of the order of dt³ in rotation and position: 1e-12 for 55 µs.
  geometry::Se3 pose_after(double dt_s) const;

 private:
  MotionState state_;
};

}  // namespace slamd::simulate
