#include "drivers/recording/pcap_reader.hpp"

#include <pcap/pcap.h>

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
    const FrameKind kind = parse_frame(link_, frame, header->len, packet);
    ++counters_.frames[static_cast<std::size_t>(kind)];
    if (kind == FrameKind::kUdp) {
      // With nanosecond precision asked for, tv_usec holds nanoseconds.
      packet.received = Stamp{} + std::chrono::seconds(header->ts.tv_sec) + Duration(header->ts.tv_usec);
      return true;
    }
  }
}

}  // namespace slamd::recording
