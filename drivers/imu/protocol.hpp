#pragma once

#include <cstdint>

namespace slamd::imu {

/// What an inertial sensor on a serial line speaks.
enum class Protocol : std::uint8_t { kCsv, kXsens, kMip };

/// Names a protocol as configured.
const char* name_of(Protocol protocol);

}  // namespace slamd::imu
