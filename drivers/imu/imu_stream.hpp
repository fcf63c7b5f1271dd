#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>

#include "core/sensor/imu_reading.hpp"
#include "drivers/imu/csv_rows.hpp"
#include "drivers/imu/mip.hpp"
#include "drivers/imu/protocol.hpp"
#include "drivers/imu/xsens.hpp"

namespace slamd::imu {

/// What became of a stream, whatever its protocol.
struct StreamSummary {
  std::uint64_t samples = 0;
  std::uint64_t refused = 0;  // rows, frames or messages that came and are no sample, though they should be
  std::uint64_t missing = 0;  // samples lost or damaged, by the device's own count
  std::uint64_t clipped = 0;  // samples that the device says are at its limits
};

/// One inertial sensor's bytes, in whichever protocol, to samples.
/// Threads: one.  Real-time: never allocates; O(bytes).
class ImuStream {
 public:
  explicit ImuStream(Protocol protocol);

  /// Takes the next bytes; calls visit(const sensor::ImuReading&) for each sample.
  template <typename Visit>
  void add(std::span<const std::byte> bytes, Stamp received, Visit&& visit) {
    if (auto* rows = std::get_if<CsvRows>(&reader_)) {
      rows->add_stream(bytes, received, visit);
    } else if (auto* xsens = std::get_if<XsensReader>(&reader_)) {
      xsens->add(bytes, received, visit);
    } else {
      std::get<MipReader>(reader_).add(bytes, received, visit);
    }
  }

  /// Ends the stream, which was interrupted: calls visit() for the samples that were still in hand.
  template <typename Visit>
  void finish(Stamp received, Visit&& visit) {
    if (auto* rows = std::get_if<CsvRows>(&reader_)) {
      rows->restart_stream();  // a row without its end is none
    } else if (auto* xsens = std::get_if<XsensReader>(&reader_)) {
      xsens->finish(received, visit);
    } else {
      std::get<MipReader>(reader_).finish(received, visit);
    }
  }

  Protocol protocol() const { return static_cast<Protocol>(reader_.index()); }
  StreamSummary summary() const;

  /// Calls visit(const char* name, std::uint64_t count) for each thing that is counted, samples first.
  template <typename Visit>
  void each_count(Visit&& visit) const {
    if (const auto* rows = std::get_if<CsvRows>(&reader_)) {
      const RowCounters counters = rows->counters();
      for (std::size_t i = 0; i < kRowResults; ++i) {
        visit(i == 0 ? "sample" : name_of(static_cast<RowResult>(i)), counters.rows[i]);
      }
    } else if (const auto* xsens = std::get_if<XsensReader>(&reader_)) {
      each_frame_count(xsens->counters(), xsens->stream(), visit);
    } else {
      const auto& mip = std::get<MipReader>(reader_);
      each_frame_count(mip.counters(), mip.stream(), visit);
    }
  }

 private:
  template <typename Visit>
  static void each_frame_count(const InertialCounters& counters, const StreamCounters& stream, Visit& visit) {
    for (std::size_t i = 0; i < kInertialResults; ++i) {
      visit(name_of(static_cast<InertialResult>(i)), counters.frames[i]);
    }
    visit("damaged", stream.damaged);
    visit("skipped_bytes", stream.skipped_bytes);
    visit("missing", counters.missing);
    visit("clipped", counters.clipped);
  }

  std::variant<CsvRows, XsensReader, MipReader> reader_;  // in the order of Protocol
};

}  // namespace slamd::imu
