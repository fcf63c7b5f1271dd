#include "drivers/livox/wire_return.hpp"

#include <cmath>
#include <numbers>

#include "core/base/bytes.hpp"
#include "core/base/units.hpp"

namespace slamd::livox {

std::array<double, 3> Direction::unit_vector() const {
  constexpr double kRadPerCdeg = std::numbers::pi / 18000.0;
  const double zenith_rad = zenith_cdeg * kRadPerCdeg;
  const double azimuth_rad = azimuth_cdeg * kRadPerCdeg;
  return {std::sin(zenith_rad) * std::cos(azimuth_rad),
          std::sin(zenith_rad) * std::sin(azimuth_rad),
          std::cos(zenith_rad)};
}

bool read_imu(std::span<const std::byte> bytes, ImuReading& reading) {
  bool finite = true;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    const auto rate_radps = load_le<float>(bytes, 4 * axis);
    const auto force_g = load_le<float>(bytes, 12 + 4 * axis);
    finite = finite && std::isfinite(rate_radps) && std::isfinite(force_g);
    reading.angular_rate_radps[i] = rate_radps;
    reading.specific_force_mps2[i] = force_g * kStandardGravity_mps2;
  }
  return finite;
}

}  // namespace slamd::livox
