#include <nlohmann/json.hpp>

#include "tools/simulate/faults.hpp"

namespace slamd::simulate {

using nlohmann::ordered_json;

namespace {

ordered_json json_of(const std::vector<Event>& events, const char* by) {
  ordered_json list = ordered_json::array();
  for (const Event& event : events) {
    list.push_back({{"at_s", event.at_s}, {by, event.by_s}});
  }
  return list;
}

ordered_json json_of(const PacketFaults& p) {
  return {{"read", p.read},           {"blackout", p.blackout},     {"gap", p.gap},
          {"burst", p.burst},         {"dropped", p.dropped},       {"truncated", p.truncated},
          {"garbage", p.garbage},     {"duplicated", p.duplicated}, {"reordered", p.reordered},
          {"clock_stepped", p.clock_stepped}, {"clipped", p.clipped},       {"written", p.written}};
}

std::uint64_t intact(const PacketFaults& p) { return p.written - p.truncated - p.garbage; }

/// What report.json must say under "blocks". A clock that jumps makes more blocks late than were reordered, and how
/// many depends on who follows it: then nothing is promised.
ordered_json expected_blocks(const FaultCounts& counts) {
  const PacketFaults& points =
      counts.of(counts.of(Wire::kVelodyneData).read != 0 ? Wire::kVelodyneData : Wire::kLivoxPoints);
  return {{"refused_duplicate", points.duplicated}, {"refused_late", points.reordered}};
}

/// What report.json must say under "packets": every packet that was written, by what becomes of it.
ordered_json expected_packets(const FaultCounts& counts) {
  ordered_json expected = ordered_json::object();
  const auto add = [&](const char* name, std::uint64_t count, bool always) {
    if (always || count != 0) {
      expected[name] = count;
    }
  };
  const PacketFaults& data = counts.of(Wire::kVelodyneData);
  const PacketFaults& position = counts.of(Wire::kVelodynePosition);
  if (data.read != 0) {
    add("data", intact(data), true);
    add("refused_wrong_length", data.truncated, false);
    add("refused_bad_block_flag", data.garbage, false);
    add("position", intact(position), true);
    add("refused_position", position.truncated + position.garbage, false);
    return expected;
  }
  const PacketFaults& points = counts.of(Wire::kLivoxPoints);
  const PacketFaults& imu = counts.of(Wire::kLivoxImu);
  if (points.read != 0) {
    add("points", intact(points), true);
    add("imu", intact(imu), true);
    add("refused_too_short", points.truncated_header + imu.truncated_header, false);
    add("refused_unknown_version", points.garbage + imu.garbage, false);
    add("refused_wrong_length", points.truncated + imu.truncated - points.truncated_header - imu.truncated_header,
        false);
  }
  return expected;
}

}  // namespace

std::string faults_json(const Faults& faults, const FaultCounts& counts) {
  ordered_json json;
  json["seed"] = faults.seed;
  json["asked"] = {{"drop", faults.drop},
                   {"burst", {{"count", faults.burst.count}, {"packets", faults.burst.packets}}},
                   {"reorder", faults.reorder},
                   {"duplicate", faults.duplicate},
                   {"truncate", faults.truncate},
                   {"garbage", faults.garbage},
                   {"clock_steps", json_of(faults.clock_steps, "by_s")},
                   {"blackouts", json_of(faults.blackouts, "lasts_s")},
                   {"imu_gaps", json_of(faults.imu_gaps, "lasts_s")},
                   {"imu_offset_s", faults.imu_offset_s}};
  if (faults.imu_clip) {
    json["asked"]["imu_clip"] = {{"rate_radps", faults.imu_clip->rate_radps},
                                 {"force_mps2", faults.imu_clip->force_mps2}};
  }
  if (faults.block_fov) {
    json["asked"]["block_fov"] = {{"from_deg", faults.block_fov->from_deg}, {"to_deg", faults.block_fov->to_deg}};
  }
  for (std::size_t i = 0; i < kWires; ++i) {
    if (counts.packets[i].read != 0) {
      json["packets"][name_of(static_cast<Wire>(i))] = json_of(counts.packets[i]);
    }
  }
  json["points_blocked"] = counts.points_blocked;
  json["frames_not_udp"] = counts.frames_not_udp;
  json["imu_rows"] = {{"read", counts.imu_rows_read},
                      {"gap", counts.imu_rows_gap},
                      {"clipped", counts.imu_rows_clipped},
                      {"written", counts.imu_rows_written}};
  json["report_packets"] = expected_packets(counts);
  if (faults.clock_steps.empty()) {
    json["report_blocks"] = expected_blocks(counts);
  }
  return json.dump(2) + "\n";
}

}  // namespace slamd::simulate
