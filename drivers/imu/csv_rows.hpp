#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/base/counter.hpp"
#include "core/sensor/imu_reading.hpp"

namespace slamd::imu {

/// What became of a row; all but the first are refusals.
enum class RowResult : std::uint8_t {
  kOk,
  kWrongColumns,     // not 7, nor 8 with a temperature
  kNotANumber,       // or an infinite one
  kStampOutOfRange,  // negative, or beyond the year 2116
  kOutOfRange,       // as InertialResult has it
  kTooLong,          // no line end within kMaxRowBytes
  kFragment,         // what a stream showed of its first row: where it began is not known
};

inline constexpr std::size_t kRowResults = 7;

/// Names a result as reports and health spell it.
const char* name_of(RowResult result);

struct RowCounters {
  std::array<std::uint64_t, kRowResults> rows{};  // by RowResult

  std::uint64_t of(RowResult result) const { return rows[static_cast<std::size_t>(result)]; }
};

/// Decodes inertial samples that come as text rows of the canonical CSV (design.md, "Configuration, recordings"),
/// without its header: timestamp_ns,gx_rad_s,gy_rad_s,gz_rad_s,ax_m_s2,ay_m_s2,az_m_s2[,temp_c].
/// Stamps are the device's own and may step; empty lines are passed over.
/// Errors: a refused row is counted by reason. Any bytes may be given.
/// Threads: one, but counters() is for any.  Real-time: never allocates; O(bytes).
class CsvRows {
 public:
  static constexpr std::size_t kMaxRowBytes = 256;

  /// Decodes the rows of one datagram, each complete: calls visit(const sensor::ImuReading&) for each good one.
  template <typename Visit>
  void add_datagram(std::span<const std::byte> bytes, Stamp received, Visit&& visit) {
    std::string_view text = text_of(bytes);
    while (!text.empty()) {
      const std::size_t end = text.find('\n');
      deliver(text.substr(0, end), received, visit);
      text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    }
  }

  /// Decodes the next bytes of a stream; a row may come in pieces and is `received` with its line end.
  template <typename Visit>
  void add_stream(std::span<const std::byte> bytes, Stamp received, Visit&& visit) {
    std::string_view text = text_of(bytes);
    while (!text.empty()) {
      const std::size_t end = text.find('\n');
      keep(text.substr(0, end));
      if (end == std::string_view::npos) {
        return;
      }
      if (const std::string_view row = finish_row(); !row.empty()) {
        deliver(row, received, visit);
      }
      text.remove_prefix(end + 1);
    }
  }

  /// Forgets the row in hand: the stream was interrupted and begins anew, perhaps in the middle of a row.
  void restart_stream();

  RowCounters counters() const;

 private:
  static std::string_view text_of(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

  template <typename Visit>
  void deliver(std::string_view row, Stamp received, Visit&& visit) {
    sensor::ImuReading reading;
    if (decode(row, reading)) {
      reading.received = received;
      visit(static_cast<const sensor::ImuReading&>(reading));
    }
  }

  bool decode(std::string_view row, sensor::ImuReading& reading);
  void keep(std::string_view piece);
  std::string_view finish_row();
  void count(RowResult result) { counters_[static_cast<std::size_t>(result)].add(); }

  std::array<Counter, kRowResults> counters_;
  std::array<char, kMaxRowBytes> row_{};  // the beginning of a stream's row
  std::size_t row_bytes_ = 0;
  bool too_long_ = false;
  bool synchronised_ = false;             // a line end was seen
};

}  // namespace slamd::imu
