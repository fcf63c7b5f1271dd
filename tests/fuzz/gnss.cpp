// Any bytes as what a satellite receiver's port carries, in pieces; as single sentences; and as the contents of good
// frames.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "core/base/assert.hpp"
#include "drivers/gnss/gnss_stream.hpp"
#include "drivers/gnss/local_frame.hpp"

namespace {

using namespace slamd::gnss;

void check(const slamd::sensor::GnssFix& fix) {
  if (!fix.is_good()) {
    return;
  }
  SLAMD_ASSERT(std::abs(fix.latitude_deg) <= 90.0 && std::abs(fix.longitude_deg) <= 180.0);
  SLAMD_ASSERT(std::isfinite(fix.altitude_m.value_or(0.0)) && std::isfinite(fix.speed_mps.value_or(0.0)));
  SLAMD_ASSERT(fix.horizontal_std_m.value_or(0.0) <= kWorstStd_m);
  LocalFrame frame;
  const auto p_enu = frame.enu_of(fix);
  SLAMD_ASSERT(!p_enu || p_enu->allFinite());
}

// Every byte of a stream is in a frame, skipped, or in hand; the same bytes give the same in any pieces.
void check_stream(std::span<const std::byte> input) {
  GnssStream whole;
  GnssStream pieces;
  std::uint64_t fixes = 0;
  const auto visit = [&](const slamd::sensor::GnssFix& fix) {
    check(fix);
    ++fixes;
  };
  whole.add(input, slamd::Stamp{}, visit);
  const std::uint64_t at_once = fixes;
  for (std::span<const std::byte> rest = input; !rest.empty();) {
    const std::size_t piece = std::min<std::size_t>(rest.size(), 1 + std::to_integer<unsigned>(rest[0]) % 64);
    pieces.add(rest.first(piece), slamd::Stamp{}, visit);
    rest = rest.subspan(piece);
  }
  SLAMD_ASSERT(fixes == 2 * at_once && pieces.pending() == whole.pending());
  GnssCounters counters = whole.counters();
  SLAMD_ASSERT(counters.messages == pieces.counters().messages && counters.fixes == pieces.counters().fixes);
  SLAMD_ASSERT(counters.stream.frame_bytes + counters.stream.skipped_bytes + whole.pending() == input.size());
  std::uint64_t sum = 0;
  for (const std::uint64_t count : counters.messages) {
    sum += count;
  }
  SLAMD_ASSERT(sum == counters.stream.frames);
  whole.finish(slamd::Stamp{}, visit);
  counters = whole.counters();
  SLAMD_ASSERT(whole.pending() == 0 && counters.stream.frame_bytes + counters.stream.skipped_bytes == input.size());
}

// What reads well writes to what reads the same.
template <typename Message>
void check_round_trip(const std::optional<Message>& message, std::string (*write)(const Message&),
                      std::optional<Message> (*parse)(std::string_view)) {
  if (message) {
    const auto again = parse(write(*message));
    SLAMD_ASSERT(again.has_value() && again->time_of_day.has_value() == message->time_of_day.has_value());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::span<const std::byte> input = std::as_bytes(std::span(bytes, size));
  check_stream(input);
  std::string body(reinterpret_cast<const char*>(bytes), std::min<std::size_t>(size, 110));
  for (const char* type : {"GNRMC,", "GPGGA,", "GNGST,"}) {
    const std::string sentence = framed(type + body);
    check_stream(std::as_bytes(std::span(sentence)));
    check_round_trip(parse_gga(sentence), write_gga, parse_gga);
    check_round_trip(parse_gst(sentence), write_gst, parse_gst);
    if (const auto rmc = parse_rmc(sentence); rmc && std::isprint(static_cast<unsigned char>(rmc->mode)) != 0 && rmc->mode != '*') {
      check_round_trip(rmc, write_rmc, parse_rmc);
    }
  }
  const UbxBytes frame = write_ubx({ubx::kNav, ubx::kNavPvt, input.first(std::min<std::size_t>(size, NavPvt::kBytes))});
  check_stream(frame.view());
  if (const auto pvt = NavPvt::parse(input.first(std::min<std::size_t>(size, NavPvt::kBytes)))) {
    const auto payload = pvt->bytes();
    SLAMD_ASSERT(std::equal(payload.begin(), payload.end(), input.begin()));
  }
  return 0;
}
