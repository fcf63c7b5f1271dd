// Any bytes into the cloud parsers, and what they make into points.
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/assert.hpp"
#include "drivers/clouds/conversion.hpp"
#include "drivers/clouds/lzf.hpp"
#include "drivers/clouds/pcd.hpp"
#include "drivers/clouds/ply.hpp"

namespace {

using namespace slamd::clouds;

void append(std::vector<std::byte>& file, std::string_view text) {
  for (const char c : text) {
    file.push_back(static_cast<std::byte>(c));
  }
}

// A header that the parsers take, so that the fuzzer's bytes get into the bodies at once.
std::vector<std::byte> with_header(std::uint8_t choice, std::span<const std::byte> body) {
  const std::string points = std::to_string(choice >> 4);
  std::vector<std::byte> file;
  const auto pcd = [&](const char* encoding) {
    append(file,
           "FIELDS x y z t ring\nSIZE 4 4 4 4 1\nTYPE F F F F U\nWIDTH " + points +
               "\nHEIGHT 1\nDATA " + encoding + "\n");
  };
  const auto ply = [&](const char* format) {
    append(file,
           "ply\nformat " + std::string(format) + " 1.0\nelement vertex " + points +
               "\nproperty float x\nproperty double y\nproperty short z\nproperty uint64 "
               "t\nend_header\n");
  };
  switch (choice % 6) {
    case 0:
      pcd("ascii");
      break;
    case 1:
      pcd("binary");
      break;
    case 2:
      pcd("binary_compressed");
      break;
    case 3:
      ply("ascii");
      break;
    case 4:
      ply("binary_little_endian");
      break;
    default:
      ply("binary_big_endian");
      break;
  }
  file.insert(file.end(), body.begin(), body.end());
  return file;
}

void check(RawCloud& raw) {
  CloudConverter converter(true);
  Cloud cloud;
  if (converter.convert(raw, cloud)) {
    return;
  }
  SLAMD_ASSERT(cloud.points.size() + cloud.empty == raw.points);
  for (const slamd::sensor::Point& point : cloud.points) {
    SLAMD_ASSERT(std::isfinite(point.x_m) && std::isfinite(point.y_m) && std::isfinite(point.z_m));
    SLAMD_ASSERT(slamd::Duration{point.offset_ns} <= cloud.span);
  }
}

void parse_all(std::span<const std::byte> file) {
  RawCloud raw;
  if (!parse_pcd(file, raw)) {
    check(raw);
  }
  if (!parse_ply(file, raw)) {
    check(raw);
  }
  if (!parse_bin(file, raw)) {
    check(raw);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::span<const std::byte> input(reinterpret_cast<const std::byte*>(bytes), size);
  parse_all(input);
  if (!input.empty()) {
    parse_all(with_header(bytes[0], input.subspan(1)));
    std::vector<std::byte> out(bytes[0] * std::size_t{4});
    lzf_unpack(input.subspan(1), out);
  }
  return 0;
}
