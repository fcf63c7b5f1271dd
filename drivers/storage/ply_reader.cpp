#include "drivers/storage/ply_reader.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>

#include "core/base/bytes.hpp"

namespace slamd::storage {

PlyReader::PlyReader(const std::filesystem::path& file) : file_(file), stream_(std::fopen(file.c_str(), "rb"), std::fclose) {
  if (!stream_) {
    throw std::runtime_error(file.string() + ": " + std::strerror(errno));
  }
  std::array<char, 128> line{};
  while (std::fgets(line.data(), line.size(), stream_.get()) != nullptr) {
    if (std::string_view(line.data()) == "end_header\n") {
      return;
    }
  }
  throw std::runtime_error(file.string() + ": has no PLY header");
}

Eigen::Vector3f PlyReader::read() {
  std::array<std::byte, 12> bytes{};
  if (std::fread(bytes.data(), 1, bytes.size(), stream_.get()) != bytes.size()) {
    throw std::runtime_error(file_.string() + ": ends before its last point");
  }
  return {load_le<float>(bytes, 0), load_le<float>(bytes, 4), load_le<float>(bytes, 8)};
}

}  // namespace slamd::storage
