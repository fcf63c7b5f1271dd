#include "drivers/storage/pcd_writer.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include "core/base/bytes.hpp"

namespace slamd::storage {

void write_pcd(const std::filesystem::path& file, std::span<const Eigen::Vector3f> points) {
  errno = 0;
  std::ofstream stream(file, std::ios::binary);
  stream << "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH "
         << points.size() << "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " << points.size() << "\nDATA binary\n";
  std::array<std::byte, 12> bytes{};
  for (const Eigen::Vector3f& p : points) {
    store_le(std::span<std::byte>(bytes), 0, p.x());
    store_le(std::span<std::byte>(bytes), 4, p.y());
    store_le(std::span<std::byte>(bytes), 8, p.z());
    stream.write(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  stream.close();
  if (!stream) {
    throw std::runtime_error(file.string() + ": " + (errno != 0 ? std::strerror(errno) : "could not be written whole"));
  }
}

}  // namespace slamd::storage
