#include "drivers/recording/pcap_reader.hpp"

#include <pcap/pcap.h>

#include <cstdint>
#include <optional>

namespace slamd::recording {

namespace {

pcap* open(const std::filesystem::path& file) {
  char why[PCAP_ERRBUF_SIZE] = {};
  pcap* handle = pcap_open_offline_with_tstamp_precision(file.c_str(), PCAP_TSTAMP_PRECISION_NANO, why);
  if (handle == nullptr) {
    const std::string cause = why;
    const std::string prefix = file.string() + ": ";
    throw RecordingError(file, cause.rfind(prefix, 0) == 0 ? cause.substr(prefix.size()) : cause);
  }
  return handle;
}

/// With nanosecond precision asked for, tv_usec holds nanoseconds. libpcap takes the unsigned seconds of a classic
/// capture for signed ones; pcapng has 64 bits for them. Errors: nothing beyond 9.2e9 s, the last that Stamp holds.
std::optional<Stamp> stamp_of(const timeval& time) {
  constexpr std::int64_t kLast_s = 9'200'000'000;
  const std::int64_t seconds = time.tv_sec;
  const std::int64_t since_1970_s = seconds < 0 && seconds >= INT32_MIN ? seconds + (std::int64_t{1} << 32) : seconds;
  if (since_1970_s < 0 || since_1970_s > kLast_s) {
    return std::nullopt;
  }
  return Stamp{} + std::chrono::seconds(since_1970_s) + Duration(time.tv_usec);
}

}  // namespace

PcapReader::PcapReader(const std::filesystem::path& file)
    : handle_(open(file), pcap_close), link_(pcap_datalink(handle_.get())) {}

PcapReader::~PcapReader() = default;

bool PcapReader::next(Packet& packet) {
  pcap_pkthdr* header = nullptr;
  const u_char* bytes = nullptr;
  for (;;) {
    const int status = pcap_next_ex(handle_.get(), &header, &bytes);
    if (status != 1) {
      counters_.ended_in_a_record = counters_.ended_in_a_record || status == PCAP_ERROR;
      return false;
    }
    const std::span<const std::byte> frame(reinterpret_cast<const std::byte*>(bytes), header->caplen);
    FrameKind kind = parse_frame(link_, frame, header->len, packet);
    const std::optional<Stamp> received = stamp_of(header->ts);
    if (kind == FrameKind::kUdp && !received) {
      kind = FrameKind::kBadStamp;
    }
    ++counters_.frames[static_cast<std::size_t>(kind)];
    if (kind == FrameKind::kUdp) {
      packet.received = *received;
      return true;
    }
  }
}

}  // namespace slamd::recording
