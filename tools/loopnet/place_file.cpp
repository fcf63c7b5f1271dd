#include "tools/loopnet/place_file.hpp"

#include <stdexcept>
#include <string>

namespace slamd::loopnet {

namespace {

constexpr std::size_t kHeaderBytes = 128;

/// The header of NumPy's format 1.0, of fixed length, so that it can be written again.
void write_header(std::ofstream& file, const std::string& type, const std::string& shape) {
  std::string text = "{'descr': '" + type + "', 'fortran_order': False, 'shape': (" + shape + "), }";
  text.resize(kHeaderBytes - 11, ' ');
  text.push_back('\n');
  std::string header("\x93NUMPY\x01\x00", 8);
  header.push_back(static_cast<char>(text.size()));
  header.push_back('\0');
  header += text;
  file.seekp(0);
  file.write(header.data(), static_cast<std::streamsize>(header.size()));
}

std::ofstream open(const std::filesystem::path& path) {
  std::ofstream file(path, std::ios::binary);
  if (!file) {
    throw std::runtime_error(path.string() + ": cannot be written");
  }
  return file;
}

}  // namespace

PlaceFile::PlaceFile(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  images_ = open(folder / "images.npy");
  contexts_ = open(folder / "contexts.npy");
  visits_ = open(folder / "visits.npy");
  write_header(images_, "|u1", "0");
  write_header(contexts_, "<f4", "0");
  write_header(visits_, "<f4", "0");
}

void PlaceFile::add(const VisitRow& row, const loop::PolarImage& image, const ScanContext& context) {
  images_.write(reinterpret_cast<const char*>(image.cells.data()), static_cast<std::streamsize>(image.cells.size()));
  contexts_.write(reinterpret_cast<const char*>(context.heights_m.data()), sizeof(context.heights_m));
  visits_.write(reinterpret_cast<const char*>(&row), sizeof(row));
  ++rows_;
}

void PlaceFile::close() {
  const std::string rows = std::to_string(rows_);
  write_header(images_, "|u1",
               rows + ", " + std::to_string(loop::PolarImage::kSlices) + ", " +
                   std::to_string(loop::PolarImage::kRings) + ", " + std::to_string(loop::PolarImage::kAzimuths));
  write_header(contexts_, "<f4",
               rows + ", " + std::to_string(ScanContext::kRings) + ", " + std::to_string(ScanContext::kSectors));
  write_header(visits_, "<f4", rows + ", " + std::to_string(sizeof(VisitRow) / sizeof(float)));
  images_.flush();
  contexts_.flush();
  visits_.flush();
  if (!images_ || !contexts_ || !visits_) {
    throw std::runtime_error("images.npy, contexts.npy or visits.npy: cannot be written");
  }
}

}  // namespace slamd::loopnet
