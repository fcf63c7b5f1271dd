#include "tools/simulate/faulty_capture.hpp"

#include <algorithm>

#include "core/base/bytes.hpp"

namespace slamd::simulate {

namespace {

bool is_within(const std::vector<Event>& events, double t_s) {
  return std::any_of(events.begin(), events.end(),
                     [&](const Event& e) { return t_s >= e.at_s && t_s < e.at_s + e.by_s; });
}

std::size_t header_bytes(Wire wire) { return wire == Wire::kLivoxPoints || wire == Wire::kLivoxImu ? 18 : 0; }

/// Noise that no decoder can take for the real thing.
void scramble(std::span<std::byte> payload, Wire wire, const Noise& noise, std::uint64_t number) {
  for (std::size_t i = 0; i < payload.size(); ++i) {
    payload[i] = static_cast<std::byte>(static_cast<unsigned>(256.0 * noise.uniform((number << 11) + i)));
  }
  if (payload.empty()) {
    return;
  }
  payload[0] = std::byte{0x5A};  // no block's flag, no version, no start of a command
  if (wire == Wire::kVelodynePosition) {
    store_le<std::uint32_t>(payload, 0xC6, 0xFFFFFFFFU);  // more than an hour
  }
}

}  // namespace

FaultyCapture::FaultyCapture(const std::filesystem::path& file, const Faults& faults, std::uint64_t packets,
                             FaultCounts& counts)
    : writer_(file), faults_(faults), counts_(counts), noise_(faults.seed, 500) {
  for (int i = 0; i < faults.burst.count; ++i) {
    burst_begins_.push_back(
        static_cast<std::uint64_t>(noise_.uniform(static_cast<std::uint64_t>(i)) * static_cast<double>(packets)));
  }
}

bool FaultyCapture::is_lost(double t_s, Wire wire, PacketFaults& counts) const {
  if (is_within(faults_.blackouts, t_s)) {
    ++counts.blackout;
    return true;
  }
  if (is_imu(wire) && is_within(faults_.imu_gaps, t_s)) {
    ++counts.gap;
    return true;
  }
  const bool in_burst = std::any_of(burst_begins_.begin(), burst_begins_.end(), [&](std::uint64_t begin) {
    return number_ >= begin && number_ < begin + static_cast<std::uint64_t>(faults_.burst.packets);
  });
  if (in_burst) {
    ++counts.burst;
    return true;
  }
  if (noise_.uniform(1000 + 8 * number_) < faults_.drop) {
    ++counts.dropped;
    return true;
  }
  return false;
}

/// Damages the bytes in hand; tells whether they are still what they were.
bool FaultyCapture::damage(Wire wire, PacketFaults& counts) {
  const double draw = noise_.uniform(1001 + 8 * number_);
  if (draw < faults_.truncate) {
    const auto length =
        static_cast<std::size_t>(noise_.uniform(1002 + 8 * number_) * static_cast<double>(payload_.size()));
    payload_.resize(length);
    ++counts.truncated;
    counts.truncated_header += length < header_bytes(wire) ? 1 : 0;
    return false;
  }
  if (draw < faults_.truncate + faults_.garbage) {
    scramble(payload_, wire, noise_, number_);
    ++counts.garbage;
    return false;
  }
  return true;
}

void FaultyCapture::write(const recording::Packet& packet, Wire wire) {
  recording::Packet written = packet;
  written.received = std::max(packet.received, last_written_);
  last_written_ = written.received;
  writer_.write(written, 0xC0A80132);
  ++counts_.of(wire).written;
}

void FaultyCapture::release(Stamp now) {
  while (!held_.empty() && held_.front().left <= 0) {
    Held held = std::move(held_.front());
    held_.pop_front();
    held.packet.received = now;
    held.packet.payload = held.payload;
    write(held.packet, held.wire);
  }
}

void FaultyCapture::add(const recording::Packet& packet) {
  const Wire wire = wire_of(packet.payload);
  PacketFaults& counts = counts_.of(wire);
  first_ = first_.value_or(packet.received);
  const double t_s = to_seconds(packet.received - *first_);
  ++counts.read;
  ++number_;
  if (is_lost(t_s, wire, counts)) {
    return;
  }
  payload_.assign(packet.payload.begin(), packet.payload.end());
  Duration step{};
  for (const Event& event : faults_.clock_steps) {
    step += t_s >= event.at_s ? from_seconds(event.by_s) : Duration{};
  }
  if (is_imu(wire)) {
    shift_clock(payload_, wire, from_seconds(faults_.imu_offset_s));
    counts.clipped += faults_.imu_clip && clip_imu(payload_, wire, *faults_.imu_clip) ? 1 : 0;
  }
  if (step != Duration{} && wire != Wire::kOther) {
    shift_clock(payload_, wire, step);
    ++counts.clock_stepped;
  }
  if (faults_.block_fov) {
    counts_.points_blocked += block_sector(payload_, wire, *faults_.block_fov);
  }
  const bool intact = damage(wire, counts);
  recording::Packet out = packet;
  out.payload = payload_;
  const double draw = noise_.uniform(1003 + 8 * number_);
  if (intact && is_points(wire) && draw < faults_.reorder) {
    // Comes after one to three later ones; one at a time, so that it is late and nothing else is.
    if (held_.empty()) {
      held_.push_back({packet, payload_, wire, 1 + static_cast<int>(3.0 * noise_.uniform(1004 + 8 * number_))});
      ++counts.reordered;
      return;
    }
  }
  write(out, wire);
  if (!intact || !is_points(wire)) {
    return;
  }
  if (draw >= faults_.reorder && draw < faults_.reorder + faults_.duplicate) {
    write(out, wire);
    ++counts.duplicated;
  }
  for (Held& held : held_) {
    --held.left;
  }
  release(packet.received);
}

void FaultyCapture::close() {
  for (Held& held : held_) {
    held.left = 0;
  }
  release(last_written_);
  writer_.close();
}

}  // namespace slamd::simulate
