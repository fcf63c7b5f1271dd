#include "drivers/storage/ply_writer.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "core/base/bytes.hpp"

namespace slamd::storage {

PlyWriter::PlyWriter(const std::filesystem::path& file) : file_(file), stream_(std::fopen(file.c_str(), "wb"), std::fclose) {
  if (!stream_) {
    throw std::runtime_error(file.string() + ": " + std::strerror(errno));
  }
  write_header();
}

void PlyWriter::write_header() {
  // The count has a fixed width, so that it can be written over once it is known.
  const int written = std::fprintf(
      stream_.get(),
      "ply\nformat binary_little_endian 1.0\nelement vertex %012llu\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n",
      static_cast<unsigned long long>(points_));
  note(written > 0);
}

void PlyWriter::write(const Eigen::Vector3f& p) {
  std::array<std::byte, 12> bytes{};
  store_le(bytes, 0, p.x());
  store_le(bytes, 4, p.y());
  store_le(bytes, 8, p.z());
  note(std::fwrite(bytes.data(), 1, bytes.size(), stream_.get()) == bytes.size());
  ++points_;
}

void PlyWriter::close() {
  if (!stream_) {
    return;
  }
  note(std::fseek(stream_.get(), 0, SEEK_SET) == 0);
  write_header();
  note(std::fclose(stream_.release()) == 0);
  if (error_ != 0) {
    throw std::runtime_error(file_.string() + ": could not be written whole: " + std::strerror(error_));
  }
}

void PlyWriter::note(bool good) {
  if (!good && error_ == 0) {
    error_ = errno;
  }
}

}  // namespace slamd::storage
