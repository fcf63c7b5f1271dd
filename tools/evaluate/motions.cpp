#include "tools/evaluate/motions.hpp"

#include <array>
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "core/base/units.hpp"
#include "drivers/recording/csv_reader.hpp"

namespace slamd::evaluate {

using evaluation::Consistency;
using evaluation::MotionClaim;
using evaluation::MotionConsistency;
using nlohmann::ordered_json;

namespace {

constexpr std::array<const char*, 6> kAxes{"x", "y", "z", "roll", "pitch", "yaw"};

ordered_json json_of(const Consistency& consistency, double freedom) {
  return {{"mean", consistency.mean / freedom}, {"inside_95", consistency.inside_95}};
}

}  // namespace

std::vector<MotionClaim> read_motions(const std::filesystem::path& file) {
  constexpr std::array<const char*, 23> kColumns{"timestamp_ns", "since_ns", "P00", "P01", "P02", "P03", "P04", "P05",
                                                 "P11", "P12", "P13", "P14", "P15", "P22", "P23", "P24", "P25", "P33",
                                                 "P34", "P35", "P44", "P45", "P55"};
  recording::CsvReader reader(file, kColumns);
  std::vector<MotionClaim> claims;
  Stamp last{};
  std::array<double, kColumns.size() - 1> values{};
  while (reader.next(last, values)) {
    MotionClaim claim{last - Duration(std::llround(values[0])), last, {}};
    std::size_t i = 1;
    for (int row = 0; row < 6; ++row) {
      for (int column = row; column < 6; ++column, ++i) {
        claim.covariance(row, column) = claim.covariance(column, row) = values[i];
      }
    }
    claims.push_back(claim);
  }
  return claims;
}

std::string json_of(const MotionConsistency& consistency) {
  ordered_json json;
  json["motions"] = consistency.pose.count;
  json["pose"] = json_of(consistency.pose, 6.0);
  json["position"] = json_of(consistency.position, 3.0);
  json["rotation"] = json_of(consistency.rotation, 3.0);
  for (std::size_t i = 0; i < kAxes.size(); ++i) {
    json[kAxes[i]] = json_of(consistency.axes[i], 1.0);
    const auto axis = static_cast<int>(i);
    const double unit = i < 3 ? 1.0 : kDegree;
    json[kAxes[i]]["error_rms"] = consistency.error_rms[axis] / unit;
    json[kAxes[i]]["claimed_rms"] = consistency.claimed_rms[axis] / unit;
  }
  return json.dump(2) + "\n";
}

std::string table_of(const MotionConsistency& consistency) {
  char line[160];
  std::snprintf(line, sizeof line, "\n%zu motions of motions.csv      NEES / freedom   within 95 %%   error rms   claimed rms\n",
                consistency.pose.count);
  std::string text = line;
  const auto add = [&](const char* name, const Consistency& c, double freedom) {
    std::snprintf(line, sizeof line, "  %-28s %12.2f %11.1f %%", name, c.mean / freedom, 100.0 * c.inside_95);
    text += line;
  };
  add("pose", consistency.pose, 6.0);
  text += "\n";
  add("position", consistency.position, 3.0);
  text += "\n";
  add("rotation", consistency.rotation, 3.0);
  text += "\n";
  for (std::size_t i = 0; i < kAxes.size(); ++i) {
    const auto axis = static_cast<int>(i);
    const double unit = i < 3 ? 1.0 : kDegree;
    add(kAxes[i], consistency.axes[i], 1.0);
    std::snprintf(line, sizeof line, " %11.4f %13.4f %s\n", consistency.error_rms[axis] / unit,
                  consistency.claimed_rms[axis] / unit, i < 3 ? "m" : "deg");
    text += line;
  }
  return text;
}

}  // namespace slamd::evaluate
