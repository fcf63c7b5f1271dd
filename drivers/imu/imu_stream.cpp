#include "drivers/imu/imu_stream.hpp"

namespace slamd::imu {

namespace {

StreamSummary summary_of(const InertialCounters& counters, const StreamCounters& stream) {
  StreamSummary summary{counters.of(InertialResult::kSample), stream.damaged, counters.missing, counters.clipped};
  for (std::size_t i = static_cast<std::size_t>(InertialResult::kIncomplete); i < kInertialResults; ++i) {
    summary.refused += counters.frames[i];
  }
  return summary;
}

}  // namespace

ImuStream::ImuStream(Protocol protocol) {
  switch (protocol) {
    case Protocol::kCsv: reader_.emplace<CsvRows>(); break;
    case Protocol::kXsens: reader_.emplace<XsensReader>(); break;
    case Protocol::kMip: reader_.emplace<MipReader>(); break;
    case Protocol::kAceinna: break;  // speaks on CAN only
  }
}

StreamSummary ImuStream::summary() const {
  if (const auto* rows = std::get_if<CsvRows>(&reader_)) {
    const RowCounters counters = rows->counters();
    StreamSummary summary{counters.of(RowResult::kOk)};
    for (std::size_t i = 1; i < kRowResults; ++i) {
      summary.refused += counters.rows[i];
    }
    return summary;
  }
  if (const auto* xsens = std::get_if<XsensReader>(&reader_)) {
    return summary_of(xsens->counters(), xsens->stream());
  }
  const auto& mip = std::get<MipReader>(reader_);
  return summary_of(mip.counters(), mip.stream());
}

}  // namespace slamd::imu
