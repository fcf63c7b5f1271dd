#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/gnss/gnss_stream.hpp"
#include "tests/hex/hex.hpp"

namespace slamd::gnss {

using hex::Bytes;
using hex::from_hex;
using hex::to_hex;

// The golden vectors of the protocol description.
inline constexpr std::string_view kGgaTextbook = "$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47";
inline constexpr std::string_view kRmcTextbook = "$GPRMC,123519,A,4807.038,N,01131.000,E,022.4,084.4,230394,003.1,W*6A";
inline constexpr std::string_view kRmcRtk =
    "$GPRMC,112525.40,A,4020.17401738,N,11637.64492453,E,16.216,171.3,011222,7.2,W,D*13";
inline constexpr std::string_view kGgaRtk =
    "$GPGGA,112525.50,4020.17357194,N,11637.64500807,E,4,17,0.9,57.4034,M,-8.4438,M,00,0149*47";
inline constexpr std::string_view kRmcEmptyCourse = "$GPRMC,153716.00,A,4529.72428,N,07339.86082,W,0.007,,180108,,,A*69";
inline constexpr std::string_view kPvt3d =
    "B56201075C00F85A7910EA07091E042E0A372700000022EDBD230301EA15EA089643254BBC0D543C00005F500000B4050000EC080000F4FFFFFFFD"
    "FFFFFFE9FFFFFF0D000000B030C701D200000080A81201A90000005C414F2100000000000000001C47";
inline constexpr std::string_view kPvtTimeOnly =
    "B56201075C00586B9E1BEA07020D082A1D3717000000917802000503EA1EED2AFD3B25502F0870A0FFFFA60B000078020000BF01000000000000"
    "00000000000000000000000000000000204E0000A671EF000F2700002C2E4C3300000000000000000F0E";
inline constexpr std::string_view kPvtM8 =
    "B56201075C0050322017E3070A110B2E08370F0000002E3A01000301EA0F464E4404FE81901E039A030046E40200D3100000B91B000089FFFFFFE5"
    "FFFFFF7CFFFFFF7A00000063FDC900FF0100001C0D4B008D000000B841473D00000000000000009D7C";
inline constexpr std::string_view kPvtPoll = "B562010700000819";

inline std::span<const std::byte> bytes_of(std::string_view text) { return std::as_bytes(std::span(text.data(), text.size())); }

/// The fixes that a stream makes of bytes.
inline std::vector<sensor::GnssFix> fixes_of(GnssStream& stream, std::span<const std::byte> bytes, Stamp received = {}) {
  std::vector<sensor::GnssFix> fixes;
  stream.add(bytes, received, [&](const sensor::GnssFix& fix) { fixes.push_back(fix); });
  return fixes;
}

}  // namespace slamd::gnss
