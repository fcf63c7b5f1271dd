#include "tools/simulate/vehicle.hpp"

#include <algorithm>
#include <cmath>

#include "tools/simulate/noise.hpp"

namespace slamd::simulate {

namespace {

constexpr double kKnot_s = Motion::kKnot_s;
constexpr double kBraking_mps2 = 0.8;
constexpr double kInBends_radps = 0.9;
constexpr double kTurning_radps2 = 4.0;

/// Goes along a line: how far it is, how fast, and where it looks.
class Driver {
 public:
  Driver(const CentreLine& line, const Ride& ride) : line_(line), ride_(ride), yaw_(heading_at(s_)) {}

  void advance(double t_s) {
    if (turning_) {
      turn();
      return;
    }
    const bool stopping = t_s < ride_.rest_s || t_s > ride_.duration_s - 2.0 ||
                          (std::fmod(t_s, 75.0) > 60.0 && std::fmod(t_s, 75.0) < 64.0);
    const double bend = std::abs(std::remainder(heading_at(s_ + 3.0) - heading_at(s_), 2.0 * M_PI)) / 3.0;
    double wanted =
        stopping ? 0.0 : std::min(ride_.speed_mps * (1.0 + 0.15 * std::sin(0.21 * t_s)), 0.7 / (bend + 1e-3));
    const double tight = std::abs(std::remainder(heading_at(s_ + 1.0) - heading_at(s_), 2.0 * M_PI));
    wanted = std::min(wanted, kInBends_radps / (tight + 1e-3));
    const double left = to_next_turn();
    wanted = std::min(wanted, std::sqrt(2.0 * 0.5 * kBraking_mps2 * std::max(0.0, left)));
    speed_ += std::clamp(wanted - speed_, -1.0 * kKnot_s, kBraking_mps2 * kKnot_s);
    if (left < 0.03 && !stopping) {
      speed_ = 0.0;
      turning_ = true;
      s_ = CentreLine::kStep_m * static_cast<double>(line_.turns[next_turn_]);
      return;
    }
    s_ += speed_ * kKnot_s;
    const double share = speed_ > 0.02 ? std::min(1.0, 3.0 * kKnot_s * (speed_ + 0.5)) : 0.0;
    yaw_ += std::remainder(heading_at(s_) - yaw_, 2.0 * M_PI) * share;
  }

  Eigen::Vector2d position() const {
    const std::size_t i = index_at(s_);
    return line_.points[i] +
           (s_ / CentreLine::kStep_m - static_cast<double>(i)) * (line_.points[i + 1] - line_.points[i]);
  }

  double s_m() const { return s_; }
  double speed() const { return speed_; }
  double yaw() const { return yaw_; }

 private:
  std::size_t index_at(double s) const {
    return std::min(static_cast<std::size_t>(s / CentreLine::kStep_m), line_.points.size() - 12);
  }

  /// The direction of the next metre, or of what is left of it before a sharp corner.
  double heading_at(double s) const {
    const std::size_t i = index_at(s);
    std::size_t ahead = i + 10;
    for (const std::size_t turn : line_.turns) {
      if (turn > i && turn < ahead) {
        ahead = turn;
      }
    }
    const Eigen::Vector2d d = line_.points[ahead] - line_.points[i];
    return std::atan2(d.y(), d.x());
  }

  double to_next_turn() const {
    return next_turn_ < line_.turns.size() ? CentreLine::kStep_m * static_cast<double>(line_.turns[next_turn_]) - s_
                                           : 1e9;
  }

  void turn() {
    const double left = std::remainder(heading_at(s_ + 0.05) - yaw_, 2.0 * M_PI);
    const double wanted =
        std::copysign(std::min(ride_.turn_rate_radps, std::sqrt(kTurning_radps2 * std::abs(left))), left);
    turn_rate_ += std::clamp(wanted - turn_rate_, -kTurning_radps2 * kKnot_s, kTurning_radps2 * kKnot_s);
    yaw_ += turn_rate_ * kKnot_s;
    if (std::abs(left) < 0.02 && std::abs(turn_rate_) < 0.3) {
      turn_rate_ = 0.0;
      turning_ = false;
      ++next_turn_;
    }
  }

  const CentreLine& line_;
  const Ride& ride_;
  double s_ = 2.0;
  double speed_ = 0.0;
  double yaw_ = 0.0;
  double turn_rate_ = 0.0;
  bool turning_ = false;
  std::size_t next_turn_ = 0;
};

/// Height of the cable ramps along the way.
double bump_m(double s, double per_100m) {
  if (per_100m <= 0.0) {
    return 0.0;
  }
  constexpr double kLength_m = 0.8;
  const double along = std::fmod(s, 100.0 / per_100m) - 50.0 / per_100m;
  return std::abs(along) < 0.5 * kLength_m ? 0.025 * (1.0 + std::cos(2.0 * M_PI * along / kLength_m)) : 0.0;
}

/// What a walker's arms add, at full pace.
void carry(Motion::Channels& c, double t_s, double share) {
  const double w = 2.0 * M_PI;
  const double burst = 0.675 - 0.325 * std::cos(w * t_s / 20.0);  // looks about every 20 s
  c[2] += share * 0.03 * std::sin(w * 1.9 * t_s);
  c[0] += share * 0.02 * std::sin(w * 0.95 * t_s) * -std::sin(c[3]);
  c[1] += share * 0.02 * std::sin(w * 0.95 * t_s) * std::cos(c[3]);
  c[3] += share * burst * 0.9 * std::sin(w * 0.33 * t_s);
  c[4] += share * 0.12 * std::sin(w * 0.9 * t_s + 1.0);
  c[5] += share * 0.14 * std::sin(w * 0.7 * t_s + 2.0);
}

Vibration vibration_of(double acceleration_mps2, const Noise& noise) {
  Vibration vibration;
  for (std::size_t i = 0; i < vibration.modes.size(); ++i) {
    const double rate = 2.0 * M_PI * noise.uniform(i, 9.0, 42.0);
    const double share =
        acceleration_mps2 * std::sqrt(2.0 / static_cast<double>(vibration.modes.size())) / (rate * rate);
    // Mostly up and down; about the axes with an arm of half a metre.
    vibration.modes[i] = {rate, noise.uniform(100 + i, 0.0, 2.0 * M_PI),
                          {0.3 * share, 0.3 * share, share, 0.1 * share, 0.5 * share, 0.5 * share}};
  }
  return vibration;
}

}  // namespace

double shake_of(double speed_mps) { return std::min(1.0, speed_mps); }

Motion::Channels Body::next(const Eigen::Vector2d& p, double yaw, double way_m, double speed_mps) {
  const auto floor = [&](double ahead, double left) {
    return route_.floor(p.x() + ahead * std::cos(yaw) - left * std::sin(yaw),
                        p.y() + ahead * std::sin(yaw) + left * std::cos(yaw)) +
           bump_m(way_m + ahead, bumps_per_100m_);
  };
  const double shake = shake_of(speed_mps);
  const double slope_pitch = -(floor(0.4, 0.0) - floor(-0.4, 0.0)) / 0.8;
  const double slope_roll = (floor(0.0, 0.3) - floor(0.0, -0.3)) / 0.6;
  const double gain = number_ == 0 ? 1.0 : 0.2;
  pitch_ += gain * (slope_pitch + 0.004 * shake * bumps_.normal(3 * number_) - pitch_);
  roll_ += gain * (slope_roll + 0.004 * shake * bumps_.normal(3 * number_ + 1) - roll_);
  const double z = floor(0.0, 0.0) + height_m_ + 0.002 * shake * bumps_.normal(3 * number_ + 2);
  ++number_;
  return {p.x(), p.y(), z, yaw, pitch_, roll_};
}

Motion drive(const Route& route, const Ride& ride, std::uint64_t seed) {
  const CentreLine line =
      centre_line(route, ride.duration_s * 1.2 * ride.speed_mps + 50.0, ride.vehicle == VehicleKind::kSkidSteer);
  Driver driver(line, ride);
  Body body(route, ride, seed);
  std::vector<Motion::Channels> points;
  std::vector<double> pace;
  double walking = 0.0;
  for (int k = 0; k * kKnot_s < ride.duration_s + 10.0 * kKnot_s; ++k) {
    driver.advance(k * kKnot_s);
    points.push_back(body.next(driver.position(), driver.yaw(), driver.s_m(), driver.speed()));
    const double shake = shake_of(driver.speed());
    walking += 0.05 * (shake - walking);
    if (ride.vehicle == VehicleKind::kHandheld) {
      carry(points.back(), k * kKnot_s, walking);
    }
    pace.push_back(shake);
  }
  Motion motion(std::move(points), kKnot_s);
  if (ride.vibration_mps2 > 0.0) {
    motion.vibrate(vibration_of(ride.vibration_mps2, Noise(seed, 4)), std::move(pace));
  }
  return motion;
}

Motion standing(const Motion::Channels& there, const Ride& ride, std::uint64_t seed) {
  Motion motion(std::vector<Motion::Channels>(6, there), kKnot_s);
  if (ride.vibration_mps2 > 0.0) {
    motion.vibrate(vibration_of(ride.vibration_mps2, Noise(seed, 4)), {});
  }
  return motion;
}

}  // namespace slamd::simulate
