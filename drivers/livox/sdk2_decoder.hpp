#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/stamp.hpp"
#include "core/sensor/point_block.hpp"
#include "drivers/livox/decode_result.hpp"
#include "drivers/livox/imu_reading.hpp"
#include "drivers/livox/sdk2_header.hpp"
#include "drivers/livox/wire_return.hpp"

namespace slamd::livox {

/// From which points to which time_interval counts: the protocol says the first, the vendor's
/// driver computes the second. They differ by less than 1.1 % of a packet (5 µs).
enum class Sdk2Interval : std::uint8_t { kFirstToLast, kFirstToNextPacket };

/// The defaults are the Mid-360's.
struct Sdk2Config {
  std::uint32_t firings_per_second = 200'000;  // where a packet does not tell; HAP: 452,000
  std::uint8_t lines = 4;                      // HAP: 6
  double min_range_m = 0.1;
  double max_range_m = 100.0;
  Sdk2Interval interval = Sdk2Interval::kFirstToLast;
};

struct Sdk2Counters {
  LivoxCounters decoded;
  std::uint64_t without_checksum = 0;       // taken all the same: the field was 0
  std::uint64_t points_packets_missing = 0;  // lost or refused, by the packets' own numbers
  std::uint64_t imu_packets_missing = 0;
};

/// Decodes the data packets of a Livox that speaks SDK2 (livox-sdk2.md §4): inertial samples, points
/// of 32 and 16 bits, spherical ones, and two echoes a firing.
///
/// A point's line is its firing's index modulo the number of lines, its offset_ns that index's share
/// of the packet's interval, rounded. Point::tag is in SDK1's words (see tag_from_sdk2). Firings
/// without a return (zero coordinates, zero depth; so are those outside the device's window of
/// view) have no point but count as empty_firings.
///
/// A checksum that does not fit is a refusal; 0 says that the sender gave none, and is counted.
/// The checksum does not cover the header's first 28 bytes: these are refused when they contradict
/// the length, the data type or the time type.
/// Real-time: never allocates; O(bytes); one thread.
class Sdk2Decoder {
 public:
  /// Errors: a rate or a number of lines of 0, or an empty range gate, is a programmer error.
  explicit Sdk2Decoder(const Sdk2Config& config);

  /// Decodes one datagram: kPoints fills block (but for its stamp, which is the ClockModel's to
  /// set), kImu fills imu. Errors: any refusal is counted by reason and leaves both untouched. Any
  /// bytes may be given.
  DecodeResult decode(std::span<const std::byte> payload,
                      Stamp received,
                      sensor::PointBlock& block,
                      ImuReading& imu);

  /// The header of the last packet that was not refused; its time type may change when the sensor
  /// (un)locks.
  const Sdk2Header& last_header() const { return last_header_; }

  const Sdk2Counters& counters() const { return counters_; }

 private:
  struct Layout;

  DecodeResult decode_checked(std::span<const std::byte> payload,
                              Stamp received,
                              sensor::PointBlock& block,
                              ImuReading& imu);
  void decode_points(const Layout& layout,
                     const Sdk2Header& header,
                     std::span<const std::byte> bytes,
                     sensor::PointBlock& block);
  bool decode_return(const Layout& layout,
                     std::span<const std::byte> bytes,
                     sensor::Point point,
                     sensor::PointBlock& block);
  void note_number(const Sdk2Header& header);
  std::uint32_t offset_ns(const Sdk2Header& header, std::size_t firing) const;

  Sdk2Config config_;
  Sdk2Header last_header_;
  std::optional<std::uint16_t> last_points_number_;
  std::optional<std::uint16_t> last_imu_number_;
  Sdk2Counters counters_;
};

/// Says an SDK2 tag in SDK1's words, which are Point::tag's. SDK2 tells for each of three causes how
/// sure the device is that the point is a normal one, SDK1 how sure it is that it is noise: little
/// confidence becomes the noise that the preprocessing drops, some confidence the kind that it keeps.
/// Source: livox-sdk2.md §4 (tag), livox-sdk1.md §5.5.
std::uint8_t tag_from_sdk2(std::uint8_t tag);

}  // namespace slamd::livox
