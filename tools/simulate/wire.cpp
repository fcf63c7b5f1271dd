#include "tools/simulate/wire.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/bytes.hpp"
#include "core/base/units.hpp"
#include "tools/simulate/mid360_lidar.hpp"

namespace slamd::simulate {

namespace {

constexpr std::size_t kLivoxHeader = 18;
constexpr std::size_t kLivox2Header = 36;
constexpr std::size_t kPointBytes = 14;
constexpr std::size_t kImuBytes = 24;
constexpr std::int64_t kHour_us = 3'600'000'000;

void reseal(std::span<std::byte> payload) { store_le(payload, 24, crc32_of(payload.subspan(28))); }

void shift_hour(std::span<std::byte> payload, std::size_t at, Duration by) {
  const std::int64_t us = (load_le<std::uint32_t>(payload, at) + by.count() / 1000) % kHour_us;
  store_le(payload, at, static_cast<std::uint32_t>(us < 0 ? us + kHour_us : us));
}

std::uint64_t block_velodyne(std::span<std::byte> payload, const Sector& sector) {
  std::uint64_t blocked = 0;
  for (std::size_t block = 0; block < 12; ++block) {
    // The azimuth grows clockwise; a block's spread of 0.4° is of no matter here.
    const double azimuth = -0.01 * load_le<std::uint16_t>(payload, 100 * block + 2);
    if (!sector.contains(azimuth)) {
      continue;
    }
    for (std::size_t i = 0; i < 32; ++i) {
      const std::size_t at = 100 * block + 4 + 3 * i;
      blocked += load_le<std::uint16_t>(payload, at) != 0 ? 1 : 0;
      store_le<std::uint16_t>(payload, at, 0);
    }
  }
  return blocked;
}

std::uint64_t block_cartesian(std::span<std::byte> payload, std::size_t header, const Sector& sector) {
  std::uint64_t blocked = 0;
  for (std::size_t at = header; at + kPointBytes <= payload.size(); at += kPointBytes) {
    const auto x = load_le<std::int32_t>(payload, at);
    const auto y = load_le<std::int32_t>(payload, at + 4);
    if ((x != 0 || y != 0) && sector.contains(std::atan2(y, x) * 180.0 / M_PI)) {
      std::fill_n(payload.begin() + static_cast<std::ptrdiff_t>(at), kPointBytes, std::byte{0});
      ++blocked;
    }
  }
  return blocked;
}

/// Firings of data types 3, 5 and 8: depth 0 is what an empty return has.
std::uint64_t block_spherical(std::span<std::byte> payload, std::size_t echoes, const Sector& sector) {
  const std::size_t firing_bytes = 4 + 6 * echoes;
  std::uint64_t blocked = 0;
  for (std::size_t at = kLivoxHeader; at + firing_bytes <= payload.size(); at += firing_bytes) {
    const std::size_t azimuth_at = at + (echoes == 1 ? 6 : 2);
    if (!sector.contains(0.01 * load_le<std::uint16_t>(payload, azimuth_at))) {
      continue;
    }
    for (std::size_t echo = 0; echo < echoes; ++echo) {
      const std::size_t depth_at = echoes == 1 ? at : at + 4 + 6 * echo;
      const std::size_t rest_at = echoes == 1 ? at + 8 : depth_at + 4;
      blocked += load_le<std::uint32_t>(payload, depth_at) != 0 ? 1 : 0;
      store_le<std::uint32_t>(payload, depth_at, 0);
      store_le<std::uint16_t>(payload, rest_at, 0);
    }
  }
  return blocked;
}

}  // namespace

const char* name_of(Wire wire) {
  switch (wire) {
    case Wire::kVelodyneData: return "velodyne_data";
    case Wire::kVelodynePosition: return "velodyne_position";
    case Wire::kLivoxPoints: return "livox_points";
    case Wire::kLivoxImu: return "livox_imu";
    case Wire::kLivox2Points: return "livox2_points";
    case Wire::kLivox2Imu: return "livox2_imu";
    case Wire::kOther: return "other";
  }
  return "?";
}

Wire wire_of(std::span<const std::byte> payload) {
  if (payload.size() == 1206 && load_le<std::uint16_t>(payload, 0) == 0xEEFF) {
    return Wire::kVelodyneData;
  }
  if (payload.size() == 512) {
    return Wire::kVelodynePosition;
  }
  if (payload.size() > kLivoxHeader && payload[0] == std::byte{5}) {
    const bool imu = payload[9] == std::byte{6};
    return !imu ? Wire::kLivoxPoints : payload.size() == kLivoxHeader + kImuBytes ? Wire::kLivoxImu : Wire::kOther;
  }
  if (payload.size() > kLivox2Header && payload[0] == std::byte{0} &&
      load_le<std::uint16_t>(payload, 1) == payload.size()) {
    const bool imu = payload[10] == std::byte{0};
    return !imu ? Wire::kLivox2Points : payload.size() == kLivox2Header + kImuBytes ? Wire::kLivox2Imu : Wire::kOther;
  }
  return Wire::kOther;
}

bool is_points(Wire wire) {
  return wire == Wire::kVelodyneData || wire == Wire::kLivoxPoints || wire == Wire::kLivox2Points;
}

bool is_imu(Wire wire) { return wire == Wire::kLivoxImu || wire == Wire::kLivox2Imu; }

void shift_clock(std::span<std::byte> payload, Wire wire, Duration by) {
  switch (wire) {
    case Wire::kVelodyneData: shift_hour(payload, 1200, by); break;
    case Wire::kVelodynePosition: shift_hour(payload, 0xC6, by); break;
    case Wire::kLivoxPoints:
    case Wire::kLivoxImu:
      if (payload[8] != std::byte{3}) {  // a date is left alone
        store_le(payload, 10, load_le<std::uint64_t>(payload, 10) + static_cast<std::uint64_t>(by.count()));
      }
      break;
    case Wire::kLivox2Points:
    case Wire::kLivox2Imu:
      store_le(payload, 28, load_le<std::uint64_t>(payload, 28) + static_cast<std::uint64_t>(by.count()));
      reseal(payload);
      break;
    case Wire::kOther: break;
  }
}

bool Sector::contains(double azimuth_deg) const {
  const auto turned = [](double deg) { return deg - 360.0 * std::floor(deg / 360.0); };
  return turned(azimuth_deg - from_deg) <= turned(to_deg - from_deg);
}

std::uint64_t block_sector(std::span<std::byte> payload, Wire wire, const Sector& sector) {
  if (wire == Wire::kVelodyneData) {
    return block_velodyne(payload, sector);
  }
  const bool cartesian = wire == Wire::kLivoxPoints &&
                         (payload[9] == std::byte{2} || payload[9] == std::byte{4} || payload[9] == std::byte{7});
  if (cartesian) {
    return block_cartesian(payload, kLivoxHeader, sector);
  }
  if (wire == Wire::kLivoxPoints) {
    switch (std::to_integer<int>(payload[9])) {
      case 3: return block_spherical(payload, 1, sector);
      case 5: return block_spherical(payload, 2, sector);
      case 8: return block_spherical(payload, 3, sector);
      default: return 0;
    }
  }
  if (wire == Wire::kLivox2Points && payload[10] == std::byte{1}) {
    const std::uint64_t blocked = block_cartesian(payload, kLivox2Header, sector);
    reseal(payload);
    return blocked;
  }
  return 0;
}

bool clip_imu(std::span<std::byte> payload, Wire wire, const InertialLimits& limits) {
  const std::size_t header = wire == Wire::kLivoxImu ? kLivoxHeader : kLivox2Header;
  bool clipped = false;
  for (std::size_t i = 0; i < 6; ++i) {
    const auto limit = static_cast<float>(i < 3 ? limits.rate_radps : limits.force_mps2 / kStandardGravity_mps2);
    const auto value = load_le<float>(payload, header + 4 * i);
    if (limit > 0.0F && std::abs(value) > limit) {
      store_le(payload, header + 4 * i, std::copysign(limit, value));
      clipped = true;
    }
  }
  if (wire == Wire::kLivox2Imu) {
    reseal(payload);
  }
  return clipped;
}

}  // namespace slamd::simulate
