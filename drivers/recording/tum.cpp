#include "drivers/recording/tum.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>

#include "drivers/recording/seconds.hpp"

namespace slamd::recording {

namespace {

/// Takes the next word off a line.
std::string_view next_word(std::string_view& line) {
  const std::size_t begin = line.find_first_not_of(" \t\r,");
  if (begin == std::string_view::npos) {
    line = {};
    return {};
  }
  line.remove_prefix(begin);
  const std::size_t end = std::min(line.find_first_of(" \t\r,"), line.size());
  const std::string_view word = line.substr(0, end);
  line.remove_prefix(end);
  return word;
}

std::optional<double> to_double(std::string_view word) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool whole = error == std::errc() && end == word.data() + word.size();
  return whole && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::string at_line(std::size_t number, const char* what) { return "line " + std::to_string(number) + ": " + what; }

/// Calls row(line number, text) for each line that is neither empty nor a comment.
template <typename Row>
void for_each_row(const std::filesystem::path& file, Row&& row) {
  std::ifstream stream(file);
  if (!stream) {
    throw RecordingError(file, "cannot be read");
  }
  std::string line;
  for (std::size_t number = 1; std::getline(stream, line); ++number) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin != std::string::npos && line[begin] != '#') {
      row(number, std::string_view(line));
    }
  }
}

template <std::size_t kCount>
std::array<double, kCount> numbers_of(const std::filesystem::path& file, std::size_t number, std::string_view text) {
  std::array<double, kCount> values{};
  for (double& value : values) {
    const auto parsed = to_double(next_word(text));
    if (!parsed) {
      throw RecordingError(file, at_line(number, ("is not " + std::to_string(kCount) + " finite numbers").c_str()));
    }
    value = *parsed;
  }
  return values;
}

}  // namespace

std::vector<StampedPose> read_tum(const std::filesystem::path& file) {
  std::vector<StampedPose> poses;
  for_each_row(file, [&](std::size_t number, std::string_view text) {
    const auto stamp = parse_seconds(next_word(text));
    if (!stamp) {
      throw RecordingError(file, at_line(number, "does not begin with a time in seconds"));
    }
    const auto v = numbers_of<7>(file, number, text);
    const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
    if (q.norm() < 1e-6) {
      throw RecordingError(file, at_line(number, "the quaternion is zero"));
    }
    poses.push_back({*stamp, geometry::Se3(q, {v[0], v[1], v[2]})});
  });
  return poses;
}

std::vector<StampedPose> read_kitti(const std::filesystem::path& file, const std::filesystem::path& times) {
  std::vector<Stamp> stamps;
  for_each_row(times, [&](std::size_t number, std::string_view text) {
    const auto stamp = parse_seconds(next_word(text));
    if (!stamp) {
      throw RecordingError(times, at_line(number, "is not a time in seconds"));
    }
    stamps.push_back(*stamp);
  });
  std::vector<StampedPose> poses;
  for_each_row(file, [&](std::size_t number, std::string_view text) {
    const auto v = numbers_of<12>(file, number, text);
    if (poses.size() == stamps.size()) {
      throw RecordingError(file, at_line(number, "has no stamp in the times file"));
    }
    Eigen::Matrix3d R;
    R << v[0], v[1], v[2], v[4], v[5], v[6], v[8], v[9], v[10];
    poses.push_back({stamps[poses.size()], geometry::Se3(Eigen::Quaterniond(R), {v[3], v[7], v[11]})});
  });
  return poses;
}

bool is_kitti(const std::filesystem::path& file) {
  std::size_t words = 0;
  bool first = true;
  for_each_row(file, [&](std::size_t, std::string_view text) {
    while (first && !next_word(text).empty()) {
      ++words;
    }
    first = false;
  });
  return words == 12;
}

void write_tum_line(std::FILE* stream, Stamp stamp, const geometry::Se3& T) {
  const std::int64_t ns = stamp.time_since_epoch().count();
  const Eigen::Quaterniond q = T.quaternion();
  const Eigen::Vector3d& p = T.translation();
  std::fprintf(stream, "%lld.%09lld %.6f %.6f %.6f %.9f %.9f %.9f %.9f\n", static_cast<long long>(ns / 1'000'000'000),
               static_cast<long long>(ns % 1'000'000'000), p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
}

}  // namespace slamd::recording
