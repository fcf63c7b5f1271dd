#include "tools/simulate/mesh_file.hpp"

#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <sstream>

#include "core/base/bytes.hpp"
#include "drivers/recording/packet.hpp"

namespace slamd::simulate {

using recording::RecordingError;

namespace {

/// A scalar type of the header, or the pair of types of a list.
struct Property {
  std::string type;
  std::string list_count;  // empty: no list
  std::string name;
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

/// Reads numbers one after another, from text or from bytes.
class Numbers {
 public:
  Numbers(const std::filesystem::path& file, std::string bytes, std::size_t at, bool ascii)
      : file_(file), bytes_(std::move(bytes)), at_(at), ascii_(ascii) {}

  double next(const std::string& type) { return ascii_ ? word() : binary(type); }

 private:
  double word() {
    at_ = bytes_.find_first_not_of(" \t\r\n", at_);
    if (at_ == std::string::npos) {
      throw RecordingError(file_, "ends before its last face");
    }
    const char* begin = bytes_.c_str() + at_;
    char* end = nullptr;
    const double value = std::strtod(begin, &end);
    if (end == begin) {
      throw RecordingError(file_, "holds a word where a number should be");
    }
    at_ += static_cast<std::size_t>(end - begin);
    return value;
  }

  template <typename T>
  double raw() {
    if (at_ + sizeof(T) > bytes_.size()) {
      throw RecordingError(file_, "ends before its last face");
    }
    const T value = load_le<T>(std::as_bytes(std::span(bytes_)), at_);
    at_ += sizeof(T);
    return static_cast<double>(value);
  }

  double binary(const std::string& type) {
    if (type == "float" || type == "float32") return raw<float>();
    if (type == "double" || type == "float64") return raw<double>();
    if (type == "uchar" || type == "uint8") return raw<std::uint8_t>();
    if (type == "char" || type == "int8") return raw<std::int8_t>();
    if (type == "ushort" || type == "uint16") return raw<std::uint16_t>();
    if (type == "short" || type == "int16") return raw<std::int16_t>();
    if (type == "uint" || type == "uint32") return raw<std::uint32_t>();
    if (type == "int" || type == "int32") return raw<std::int32_t>();
    throw RecordingError(file_, "has a property of the unknown type " + type);
  }

  const std::filesystem::path& file_;
  std::string bytes_;
  std::size_t at_;
  bool ascii_;
};

/// The header's elements, and where the numbers begin.
struct Header {
  bool ascii = true;
  std::size_t end = 0;
  std::vector<Element> elements;
};

Header read_header(const std::filesystem::path& file, const std::string& bytes) {
  Header header;
  const std::size_t mark = bytes.find("end_header");
  const std::size_t end = mark == std::string::npos ? mark : bytes.find('\n', mark);
  if (bytes.compare(0, 3, "ply") != 0 || end == std::string::npos) {
    throw RecordingError(file, "is no PLY file");
  }
  header.end = end + 1;
  std::istringstream lines(bytes.substr(0, mark));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string key;
    std::string name;
    words >> key >> name;
    if (key == "format") {
      if (name != "ascii" && name != "binary_little_endian") {
        throw RecordingError(file, "is written as " + name + ", which is not read");
      }
      header.ascii = name == "ascii";
    } else if (key == "element") {
      header.elements.push_back({name, 0, {}});
      words >> header.elements.back().count;
    } else if (key == "property" && !header.elements.empty()) {
      Property property;
      property.type = name;
      if (name == "list") {
        words >> property.list_count >> property.type;
      }
      words >> property.name;
      header.elements.back().properties.push_back(property);
    }
  }
  return header;
}

}  // namespace

std::vector<Triangle> read_mesh(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    throw RecordingError(file, std::strerror(errno));
  }
  std::string bytes((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  const Header header = read_header(file, bytes);
  Numbers numbers(file, std::move(bytes), header.end, header.ascii);
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Triangle> triangles;
  for (const Element& element : header.elements) {
    for (std::size_t i = 0; i < element.count; ++i) {
      std::map<std::string, double> scalars;
      std::vector<std::size_t> corners;
      for (const Property& property : element.properties) {
        if (property.list_count.empty()) {
          scalars[property.name] = numbers.next(property.type);
          continue;
        }
        const double count = numbers.next(property.list_count);
        for (double k = 0; k < count; ++k) {
          corners.push_back(static_cast<std::size_t>(std::max(0.0, numbers.next(property.type))));
        }
      }
      if (element.name == "vertex") {
        vertices.emplace_back(static_cast<float>(scalars["x"]), static_cast<float>(scalars["y"]),
                              static_cast<float>(scalars["z"]));
      } else if (element.name == "face") {
        for (std::size_t k = 2; k < corners.size(); ++k) {
          if (std::max({corners[0], corners[k - 1], corners[k]}) >= vertices.size()) {
            throw RecordingError(file, "has a face with a corner that does not exist");
          }
          triangles.push_back({{vertices[corners[0]], vertices[corners[k - 1]], vertices[corners[k]]}, 0.4F});
        }
      }
    }
  }
  if (triangles.empty()) {
    throw RecordingError(file, "has no faces");
  }
  return triangles;
}

}  // namespace slamd::simulate
