// Any file into the capture reader: as it is, and as one frame in a good capture file.
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/base/assert.hpp"
#include "drivers/recording/pcap_reader.hpp"

namespace {

// In memory, where there is such a place.
const std::filesystem::path& scratch_file() {
  static const std::filesystem::path file =
      std::filesystem::path(std::filesystem::is_directory("/dev/shm") ? "/dev/shm" : "/tmp") /
      ("slamd_fuzz_capture_" + std::to_string(getpid()));
  return file;
}

void write(std::span<const std::uint8_t> head, std::span<const std::uint8_t> rest) {
  std::FILE* stream = std::fopen(scratch_file().c_str(), "wb");
  SLAMD_ASSERT(stream != nullptr);
  std::fwrite(head.data(), 1, head.size(), stream);
  std::fwrite(rest.data(), 1, rest.size(), stream);
  std::fclose(stream);
}

void read_all() {
  try {
    slamd::recording::PcapReader reader(scratch_file());
    slamd::recording::Packet packet;
    unsigned sum = 0;
    while (reader.next(packet)) {
      for (const std::byte byte : packet.payload) {
        sum += std::to_integer<unsigned>(byte);  // touches each byte, for the sanitizer
      }
    }
    [[maybe_unused]] static volatile unsigned sink;
    sink = sum;
  } catch (const slamd::recording::RecordingError&) {
    // What it is to do with a file that is no capture.
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::span<const std::uint8_t> input(bytes, size);
  write({}, input);
  read_all();
  if (size > 1 && size < 60'000) {
    // The first byte chooses the link layer, the rest is the frame: Ethernet, cooked, raw IP, null, cooked v2.
    constexpr std::uint8_t kLinks[] = {1, 113, 101, 0, 20};  // 276 = 0x114 has two bytes
    const std::uint8_t choice = input[0] % 5;
    const auto low = static_cast<std::uint8_t>(size - 1);
    const auto high = static_cast<std::uint8_t>((size - 1) >> 8U);
    const std::vector<std::uint8_t> head = {
        0xD4, 0xC3, 0xB2, 0xA1, 2,   0,    4, 0, 0,   0,    0, 0, 0, 0, 0, 0, 0, 0, 1, 0,
        kLinks[choice], static_cast<std::uint8_t>(choice == 4 ? 1 : 0), 0, 0,  // file header ends
        0, 0, 0, 0, 0, 0, 0, 0, low, high, 0, 0, low, high, 0, 0};
    write(head, input.subspan(1));
    read_all();
  }
  std::filesystem::remove(scratch_file());
  return 0;
}
