// Any file into the CSV and trajectory readers.
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/assert.hpp"
#include "drivers/recording/csv_reader.hpp"
#include "drivers/recording/tum.hpp"

namespace {

const std::filesystem::path& scratch_file() {
  static const std::filesystem::path file =
      std::filesystem::path(std::filesystem::is_directory("/dev/shm") ? "/dev/shm" : "/tmp") /
      ("slamd_fuzz_csv_" + std::to_string(getpid()));
  return file;
}

void write(std::string_view head, std::string_view rest) {
  std::FILE* stream = std::fopen(scratch_file().c_str(), "wb");
  SLAMD_ASSERT(stream != nullptr);
  std::fwrite(head.data(), 1, head.size(), stream);
  std::fwrite(rest.data(), 1, rest.size(), stream);
  std::fclose(stream);
}

void read_imu() {
  try {
    slamd::recording::ImuCsvReader reader(scratch_file());
    slamd::sensor::ImuSample sample;
    std::optional<slamd::Stamp> last;
    while (reader.next(sample)) {
      SLAMD_ASSERT(!last || sample.stamp > *last);
      last = sample.stamp;
    }
  } catch (const slamd::recording::RecordingError&) {
    // A header without the columns.
  }
}

void read_trajectory() {
  try {
    for (const slamd::recording::StampedPose& pose : slamd::recording::read_tum(scratch_file())) {
      SLAMD_ASSERT(pose.T.translation().allFinite());
    }
  } catch (const slamd::recording::RecordingError&) {
    // A line that is no pose.
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::string_view input(reinterpret_cast<const char*>(bytes), size);
  write("", input);
  read_imu();
  read_trajectory();
  write("timestamp_ns,gx_rad_s,gy_rad_s,gz_rad_s,ax_m_s2,ay_m_s2,az_m_s2\n", input);
  read_imu();
  std::filesystem::remove(scratch_file());
  return 0;
}
