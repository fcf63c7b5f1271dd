#pragma once

#include <array>
#include <cstdint>
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
enum class RowRefusal : std::uint8_t { kTooFewColumns, kNotANumber, kTimeNotIncreasing };

inline constexpr std::size_t kRowRefusals = 3;

const char* name_of(RowRefusal reason);

struct CsvCounters {
  std::uint64_t rows = 0;  // taken
  std::array<std::uint64_t, kRowRefusals> refused{};
  std::uint64_t first_refused_line = 0;  // 1-based; 0: none
};

/// Reads the named columns of a CSV file, whatever their order; the first is the stamp in integer nanoseconds.
/// Errors: RecordingError for a file that cannot be read, and for a header in which a column is missing (which is
/// named); bad rows are counted by reason and passed over. Extra columns are ignored.
class CsvReader {
 public:
  CsvReader(const std::filesystem::path& file, std::span<const char* const> columns);

  /// Reads the next good row: the stamp and the other columns in the order they were named.
  /// Shapes: values[columns − 1].
  bool next(Stamp& stamp, std::span<double> values);

  const CsvCounters& counters() const { return counters_; }

 private:
  std::optional<RowRefusal> parse(Stamp& stamp, std::span<double> values) const;

  std::filesystem::path file_;
  std::ifstream stream_;
  std::string line_;
  std::uint64_t line_number_ = 0;
  std::vector<std::size_t> places_;  // of the named columns among the file's
  std::optional<Stamp> last_;
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
