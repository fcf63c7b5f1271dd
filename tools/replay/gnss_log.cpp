#include "tools/replay/gnss_log.hpp"

#include <array>
#include <fstream>

#include "drivers/recording/csv_reader.hpp"

namespace slamd::replay {

using recording::RecordingError;

namespace {

GnssSummary read_rows(const std::filesystem::path& file) {
  recording::GnssCsvReader reader(file);
  stages::GnssStage stage;
  for (sensor::GnssFix fix; reader.next(fix);) {
    stage.add_fix(fix);
  }
  GnssSummary summary{stage.state(), {}};
  if (const std::uint64_t none = summary.state.fixes - summary.state.good; none != 0) {
    summary.refused.emplace_back("no_fix", none);
  }
  for (std::size_t i = 0; i < recording::kRowRefusals; ++i) {
    if (const auto count = reader.counters().refused[i]; count != 0) {
      summary.refused.emplace_back(std::string("row_") + name_of(static_cast<recording::RowRefusal>(i)), count);
    }
  }
  return summary;
}

GnssSummary read_stream(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    throw RecordingError(file, "cannot be read");
  }
  stages::GnssStage stage;
  std::array<char, 4096> piece{};
  do {
    stream.read(piece.data(), piece.size());
    stage.add(std::as_bytes(std::span(piece).first(static_cast<std::size_t>(stream.gcount()))), Stamp{});
  } while (stream);
  stage.finish(Stamp{});
  return gnss_summary(stage);
}

}  // namespace

GnssSummary gnss_summary(const stages::GnssStage& stage) {
  GnssSummary summary{stage.state(), stage.counts()};
  summary.refused.erase(summary.refused.begin());  // the good fixes
  return summary;
}

GnssSummary read_gnss(const std::filesystem::path& file) {
  return file.extension() == ".csv" ? read_rows(file) : read_stream(file);
}

}  // namespace slamd::replay
