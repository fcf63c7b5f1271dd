// Any bytes into the decoder of inertial rows, as one datagram and as a stream in pieces.
#include <algorithm>
#include <cstdint>
#include <span>

#include "core/base/assert.hpp"
#include "drivers/imu/csv_rows.hpp"

namespace {

void check(const slamd::sensor::ImuReading& reading) {
  SLAMD_ASSERT(reading.device_stamp >= slamd::DeviceStamp{});
  SLAMD_ASSERT(reading.angular_rate_radps.allFinite() && reading.specific_force_mps2.allFinite());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  std::span<const std::byte> input = std::as_bytes(std::span(bytes, size));
  slamd::imu::CsvRows rows;
  std::uint64_t good = 0;
  const auto visit = [&](const slamd::sensor::ImuReading& reading) {
    check(reading);
    ++good;
  };
  rows.add_datagram(input, slamd::Stamp{}, visit);
  while (!input.empty()) {
    const std::size_t piece = std::min<std::size_t>(input.size(), 1 + static_cast<std::uint8_t>(input[0]) % 64);
    rows.add_stream(input.first(piece), slamd::Stamp{}, visit);
    if (input[0] == std::byte{0}) {
      rows.restart_stream();
    }
    input = input.subspan(piece);
  }
  SLAMD_ASSERT(rows.counters().of(slamd::imu::RowResult::kOk) == good);
  return 0;
}
