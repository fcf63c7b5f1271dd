#include "tools/plot/png.hpp"

#include <png.h>

#include <stdexcept>

namespace slamd::plot {

namespace {

void append(png_structp png, png_bytep bytes, png_size_t size) {
  auto* out = static_cast<std::vector<std::byte>*>(png_get_io_ptr(png));
  const auto* begin = reinterpret_cast<const std::byte*>(bytes);
  out->insert(out->end(), begin, begin + size);
}

void flush(png_structp) {}

// Thrown through libpng's C frames, which Debian builds with unwind tables: libpng's manual allows
// it instead of longjmp, which would skip destructors.
[[noreturn]] void refuse(png_structp, png_const_charp why) {
  throw std::runtime_error(std::string("PNG: ") + why);
}

void ignore(png_structp, png_const_charp) {}

/// Owns libpng's two structures.
class Writer {
 public:
  Writer()
      : png_(png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, refuse, ignore)),
        info_(nullptr) {
    if (png_ == nullptr) {
      throw std::runtime_error("PNG: libpng does not start");
    }
    info_ = png_create_info_struct(png_);
  }

  ~Writer() { png_destroy_write_struct(&png_, &info_); }

  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;

  png_structp png() const { return png_; }

  png_infop info() const { return info_; }

 private:
  png_structp png_;
  png_infop info_;
};

}  // namespace

std::vector<std::byte> png_of(const IndexedImage& image) {
  if (image.width * image.height == 0 || image.pixels.size() != image.width * image.height ||
      image.palette.empty() || image.palette.size() > 256) {
    throw std::runtime_error("PNG: a picture has width × height pixels and 1 to 256 colours");
  }
  std::vector<std::byte> bytes;
  const Writer writer;
  png_set_write_fn(writer.png(), &bytes, append, flush);
  png_set_compression_level(writer.png(), 9);
  png_set_IHDR(writer.png(),
               writer.info(),
               static_cast<png_uint_32>(image.width),
               static_cast<png_uint_32>(image.height),
               8,
               PNG_COLOR_TYPE_PALETTE,
               PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  std::vector<png_color> palette;
  for (const Rgb& colour : image.palette) {
    palette.push_back({colour.r, colour.g, colour.b});
  }
  png_set_PLTE(writer.png(), writer.info(), palette.data(), static_cast<int>(palette.size()));
  png_write_info(writer.png(), writer.info());
  for (std::size_t row = 0; row < image.height; ++row) {
    png_write_row(writer.png(), image.pixels.data() + row * image.width);
  }
  png_write_end(writer.png(), writer.info());
  return bytes;
}

std::string base64(std::span<const std::byte> bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      word = word << 8 | (i + k < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k <= bytes.size() ? kDigits[word >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return text;
}

}  // namespace slamd::plot
