#include "tools/simulate/fault_injector.hpp"

#include <algorithm>
#include <cmath>

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

FaultInjector::FaultInjector(const Faults& faults, double length_s) : faults_(faults), noise_(faults.seed, 500) {
  for (int i = 0; i < faults.burst.count; ++i) {
    bursts_s_.push_back(noise_.uniform(static_cast<std::uint64_t>(i)) * length_s);
  }
  std::sort(bursts_s_.begin(), bursts_s_.end(), std::greater<>());
}

bool FaultInjector::is_in_burst(double t_s) {
  for (; !bursts_s_.empty() && bursts_s_.back() <= t_s; bursts_s_.pop_back()) {
    burst_end_ = number_ + static_cast<std::uint64_t>(faults_.burst.packets);
  }
  return number_ < burst_end_;
}

bool FaultInjector::is_lost(double t_s, Wire wire, PacketFaults& counts) {
  const bool in_burst = is_in_burst(t_s);
  if (is_within(faults_.blackouts, t_s)) {
    ++counts.blackout;
    return true;
  }
  if (is_imu(wire) && is_within(faults_.imu_gaps, t_s)) {
    ++counts.gap;
    return true;
  }
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
bool FaultInjector::damage(Wire wire, PacketFaults& counts) {
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

void FaultInjector::hand_on(const recording::Packet& packet, Wire wire, const Sink& sink) {
  recording::Packet out = packet;
  out.received = std::max(packet.received, last_);
  last_ = out.received;
  ++counts_.of(wire).written;
  sink(out);
}

void FaultInjector::release(Stamp now, const Sink& sink) {
  while (!held_.empty() && held_.front().left <= 0) {
    Held held = std::move(held_.front());
    held_.pop_front();
    held.packet.received = now;
    held.packet.payload = held.payload;
    hand_on(held.packet, held.wire, sink);
  }
}

void FaultInjector::add(const recording::Packet& packet, const Sink& sink) {
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
  hand_on(out, wire, sink);
  if (!intact || !is_points(wire)) {
    return;
  }
  if (draw >= faults_.reorder && draw < faults_.reorder + faults_.duplicate) {
    hand_on(out, wire, sink);
    ++counts.duplicated;
  }
  for (Held& held : held_) {
    --held.left;
  }
  release(packet.received, sink);
}

void FaultInjector::finish(const Sink& sink) {
  for (Held& held : held_) {
    held.left = 0;
  }
  release(last_, sink);
}

bool FaultInjector::pass_row(Stamp& stamp) {
  ++counts_.imu_rows_read;
  first_row_ = first_row_.value_or(stamp);
  if (is_within(faults_.imu_gaps, to_seconds(stamp - *first_row_))) {
    ++counts_.imu_rows_gap;
    return false;
  }
  stamp += from_seconds(faults_.imu_offset_s);
  ++counts_.imu_rows_written;
  return true;
}

bool FaultInjector::pass(sensor::ImuSample& row) {
  if (!pass_row(row.stamp)) {
    return false;
  }
  if (faults_.imu_clip) {
    const sensor::ImuSample before = row;
    const auto cut = [](double limit) {
      return [limit](double value) { return limit > 0.0 ? std::clamp(value, -limit, limit) : value; };
    };
    row.angular_rate_radps = before.angular_rate_radps.unaryExpr(cut(faults_.imu_clip->rate_radps));
    row.specific_force_mps2 = before.specific_force_mps2.unaryExpr(cut(faults_.imu_clip->force_mps2));
    counts_.imu_rows_clipped += row.angular_rate_radps != before.angular_rate_radps ||
                                        row.specific_force_mps2 != before.specific_force_mps2
                                    ? 1
                                    : 0;
  }
  return true;
}

}  // namespace slamd::simulate
