#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/sensor/gnss_fix.hpp"
#include "core/sensor/imu_sample.hpp"
#include "core/sensor/wheel_sample.hpp"
#include "drivers/recording/packet.hpp"

namespace slamd::recording {

/// Why a row was not taken.
enum class RowRefusal : std::uint8_t { kTooFewColumns, kNotANumber, kTimeNotIncreasing, kTimeFarAhead };

inline constexpr std::size_t kRowRefusals = 4;

const char* name_of(RowRefusal reason);

struct CsvCounters {
  std::uint64_t rows = 0;  // taken
  std::array<std::uint64_t, kRowRefusals> refused{};
  std::uint64_t first_refused_line = 0;  // 1-based; 0: none
  std::uint64_t steps_back = 0;          // of the stamps' clock, taken off
};

/// Reads the named columns of a CSV file, whatever their order; the first is the stamp in integer nanoseconds.
/// Errors: RecordingError for a file that cannot be read, and for a header in which a column is missing (which is
/// named); bad rows are counted by reason and passed over. Extra columns are ignored.
///
/// A stamp counts for what the rows after it make of it. One that is ahead of a later row by more than kLeap is wild
/// (kTimeFarAhead). Where all the next rows are old, but in order, the clock has stepped back: they go on from the row before.
/// A step forward looks like a gap, and is taken for one.
class CsvReader {
 public:
  static constexpr Duration kLeap = std::chrono::milliseconds{500};
  static constexpr Duration kSlowest = std::chrono::seconds{5};  // rows of one file lie closer together, where they are to tell of a step

  CsvReader(const std::filesystem::path& file, std::span<const char* const> columns);

  /// Reads the next good row: the stamp and the other columns in the order they were named.
  /// Shapes: values[columns − 1].
  bool next(Stamp& stamp, std::span<double> values);

  const CsvCounters& counters() const { return counters_; }

 private:
  struct Row {
    Stamp stamp{};
    std::vector<double> values;
    std::uint64_t line = 0;
  };

  void read_ahead();
  std::optional<RowRefusal> parse(Row& row) const;
  std::optional<RowRefusal> disorder(const Row& row);
  bool is_far_ahead(const Row& row) const;
  bool has_stepped_back(const Row& row) const;
  void refuse(RowRefusal reason, std::uint64_t line);

  std::filesystem::path file_;
  std::ifstream stream_;
  std::string line_;
  std::uint64_t line_number_ = 0;
  std::vector<std::size_t> places_;  // of the named columns among the file's
  std::deque<Row> ahead_;           // read, and not yet given
  std::optional<Stamp> last_;       // that was given
  std::uint64_t taken_off_ns_ = 0;  // of all stamps since a step back, modulo 2^64
  CsvCounters counters_;
};

/// Reads an imu.csv (design.md, "Configuration, recordings"): rad/s and m/s² in the imu frame.
class ImuCsvReader {
 public:
  explicit ImuCsvReader(const std::filesystem::path& file);

  bool next(sensor::ImuSample& sample);

  const CsvCounters& counters() const { return csv_.counters(); }

 private:
  CsvReader csv_;
};

/// Reads an odom.csv: the speeds of base, m/s and rad/s.
class WheelCsvReader {
 public:
  explicit WheelCsvReader(const std::filesystem::path& file);

  bool next(sensor::WheelSample& sample);

  const CsvCounters& counters() const { return csv_.counters(); }

 private:
  CsvReader csv_;
};

/// Reads a gnss.csv: places and heights on the WGS-84 ellipsoid. A row whose place cannot be has quality kNone.
class GnssCsvReader {
 public:
  explicit GnssCsvReader(const std::filesystem::path& file);

  bool next(sensor::GnssFix& fix);

  const CsvCounters& counters() const { return csv_.counters(); }

 private:
  CsvReader csv_;
};

}  // namespace slamd::recording
