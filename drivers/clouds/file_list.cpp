#include "drivers/clouds/file_list.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <fstream>
#include <string>

#include "drivers/recording/packet.hpp"
#include "drivers/recording/seconds.hpp"

namespace slamd::clouds {

namespace fs = std::filesystem;
using recording::RecordingError;

namespace {

constexpr const char* kSubfolders[] =
    {".", "velodyne", "velodyne_points/data", "data", "clouds", "Scans", "Ouster"};
constexpr std::int64_t kLatest_ns = 9'200'000'000'000'000'000;
constexpr const char* kTimesFiles[] = {"times.txt", "timestamps.txt"};

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// Takes a run of digits, or of other characters, off the front.
std::string_view take_run(std::string_view& text) {
  std::size_t end = 1;
  while (end < text.size() && is_digit(text[end]) == is_digit(text[0])) {
    ++end;
  }
  const std::string_view run = text.substr(0, end);
  text.remove_prefix(end);
  return run;
}

std::string_view without_zeros(std::string_view digits) {
  return digits.substr(std::min(digits.find_first_not_of('0'), digits.size()));
}

/// Compares names with the numbers in them as numbers.
bool comes_before(std::string_view a, std::string_view b) {
  while (!a.empty() && !b.empty()) {
    std::string_view run_a = take_run(a);
    std::string_view run_b = take_run(b);
    if (is_digit(run_a[0]) && is_digit(run_b[0])) {
      run_a = without_zeros(run_a);
      run_b = without_zeros(run_b);
      if (run_a.size() != run_b.size()) {
        return run_a.size() < run_b.size();
      }
    }
    if (run_a != run_b) {
      return run_a < run_b;
    }
  }
  return a.size() < b.size();
}

/// The files of the most frequent of the three kinds, in their order.
std::vector<fs::path> clouds_in(const fs::path& folder) {
  std::array<std::vector<fs::path>, 3> kinds;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
      if (extension == std::array{".bin", ".pcd", ".ply"}[kind] && entry.is_regular_file()) {
        kinds[kind].push_back(entry.path());
      }
    }
  }
  auto& most = *std::max_element(
      kinds.begin(), kinds.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
  std::sort(most.begin(), most.end(), [](const fs::path& a, const fs::path& b) {
    const std::string stem_a = a.stem().string();
    const std::string stem_b = b.stem().string();
    return comes_before(stem_a, stem_b) || (!comes_before(stem_b, stem_a) && stem_a < stem_b);
  });
  return std::move(most);
}

template <typename T>
bool take_number(std::string_view& text, char separator, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const auto used = static_cast<std::size_t>(end - text.data());
  if (error != std::errc() ||
      (separator != '\0' && (used >= text.size() || text[used] != separator))) {
    return false;
  }
  text.remove_prefix(used + (separator == '\0' ? 0 : 1));
  return true;
}

/// Reads KITTI's "2011-09-26 13:02:25.964389445" as UTC.
std::optional<Stamp> parse_date(std::string_view text) {
  int year = 0;
  unsigned month = 0;
  unsigned day = 0;
  int hour = 0;
  int minute = 0;
  if (!take_number(text, '-', year) || !take_number(text, '-', month) ||
      !take_number(text, ' ', day) || !take_number(text, ':', hour) ||
      !take_number(text, ':', minute)) {
    return std::nullopt;
  }
  const std::chrono::year_month_day date{
      std::chrono::year{year}, std::chrono::month{month}, std::chrono::day{day}};
  const auto seconds = recording::parse_seconds(text);
  const bool good = date.ok() && year >= 1970 && year < 2262 && hour >= 0 && hour < 24 &&
                    minute >= 0 && minute < 60 && seconds && *seconds >= Stamp{} &&
                    *seconds < Stamp{std::chrono::seconds{61}};
  if (!good) {
    return std::nullopt;
  }
  return *seconds + std::chrono::sys_days{date}.time_since_epoch() + std::chrono::hours{hour} +
         std::chrono::minutes{minute};
}

std::vector<Stamp> read_times(const fs::path& file) {
  std::ifstream stream(file);
  std::vector<Stamp> stamps;
  std::string line;
  for (std::size_t number = 1; std::getline(stream, line); ++number) {
    std::string_view text = line;
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())) != 0) {
      text.remove_suffix(1);
    }
    if (text.empty() || text.front() == '#') {
      continue;
    }
    const bool is_date = text.find(':') != std::string_view::npos;
    const auto stamp = is_date ? parse_date(text) : recording::parse_seconds(text);
    if (!stamp) {
      throw RecordingError(file, "line " + std::to_string(number) + " is no time");
    }
    stamps.push_back(*stamp);
  }
  return stamps;
}

std::optional<Stamp> stamp_of_name(const std::string& stem) {
  if (stem.find('.') != std::string::npos) {
    return recording::parse_seconds(stem);
  }
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(stem.data(), stem.data() + stem.size(), value);
  if (error != std::errc() || end != stem.data() + stem.size() || stem.front() == '0') {
    return std::nullopt;
  }
  const std::int64_t unit_ns = stem.size() == 13 ? 1'000'000 : (stem.size() == 16 ? 1'000 : 1);
  const bool is_stamp = stem.size() == 13 || stem.size() == 16 || stem.size() == 19;
  return is_stamp && value <= kLatest_ns / unit_ns ? std::optional(Stamp{Duration{value * unit_ns}})
                                                   : std::nullopt;
}

bool stamps_from_names(FileList& list) {
  for (CloudFile& file : list.files) {
    file.stamp = stamp_of_name(file.path.stem().string());
    if (!file.stamp) {
      return false;
    }
  }
  std::stable_sort(list.files.begin(),
                   list.files.end(),
                   [](const CloudFile& a, const CloudFile& b) { return *a.stamp < *b.stamp; });
  return true;
}

bool stamps_from_times_file(const fs::path& folder, FileList& list) {
  const fs::path normal = fs::absolute(folder).lexically_normal();
  // "clouds/" has an empty last part, whose parent is "clouds" itself.
  const fs::path above = (normal.has_filename() ? normal : normal.parent_path()).parent_path();
  for (const fs::path& place : {folder, above}) {
    for (const char* name : kTimesFiles) {
      if (!fs::exists(place / name)) {
        continue;
      }
      const std::vector<Stamp> stamps = read_times(place / name);
      for (std::size_t i = 0; i < std::min(stamps.size(), list.files.size()); ++i) {
        list.files[i].stamp = stamps[i];
      }
      return true;
    }
  }
  return false;
}

}  // namespace

std::string_view name_of(StampSource source) {
  switch (source) {
    case StampSource::kTimesFile:
      return "times_file";
    case StampSource::kFileNames:
      return "file_names";
    case StampSource::kPointTimes:
      return "point_times";
    case StampSource::kRate:
      return "rate";
  }
  return "?";
}

FileList list_clouds(const fs::path& folder) {
  if (!fs::is_directory(folder)) {
    throw RecordingError(folder, "is no folder of clouds");
  }
  FileList list;
  for (const char* subfolder : kSubfolders) {
    const fs::path place = (folder / subfolder).lexically_normal();
    if (!list.files.empty() || !fs::is_directory(place)) {
      continue;
    }
    for (const fs::path& path : clouds_in(place)) {
      list.files.push_back({path, std::nullopt});
    }
    if (list.files.empty()) {
      continue;
    }
    if (stamps_from_times_file(place, list)) {
      list.stamps_are_known = true;
      list.source = StampSource::kTimesFile;
    } else if (stamps_from_names(list)) {
      list.stamps_are_known = true;
      list.source = StampSource::kFileNames;
    }
  }
  if (list.files.empty()) {
    throw RecordingError(folder, "holds no clouds (*.bin, *.pcd, *.ply)");
  }
  return list;
}

}  // namespace slamd::clouds
