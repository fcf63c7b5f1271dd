#include "drivers/velodyne/decoder.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/bytes.hpp"

namespace slamd::velodyne {

namespace {

constexpr int kBlocks = 12;
constexpr std::size_t kBlockBytes = 100;
constexpr std::size_t kBlockHeader = 4;
constexpr std::size_t kReturnBytes = 3;
constexpr std::size_t kTimestampAt = 1200;
constexpr std::size_t kReturnModeAt = 1204;
constexpr std::size_t kProductAt = 1205;
constexpr std::uint16_t kBlockFlag = 0xEEFF;
constexpr std::uint32_t kHour_us = 3'600'000'000U;
constexpr double kTurn_cdeg = 36000.0;
constexpr double kRadiansPerCdeg = M_PI / 18000.0;

constexpr std::uint8_t kStrongest = 0x37;
constexpr std::uint8_t kLast = 0x38;
constexpr std::uint8_t kDual = 0x39;

/// At 20 Hz the head turns 0.8° between blocks of a VLP-16; more than this is a hole in the data, not a turn.
constexpr double kMaxGap_cdeg = 150.0;

/// How far the head turns from one azimuth to the next.
double turn_cdeg(std::uint16_t from_cdeg, std::uint16_t to_cdeg) {
  return std::fmod(to_cdeg - from_cdeg + kTurn_cdeg, kTurn_cdeg);
}

/// std::lround of a number that is 0, or 1 and more: there x + 0.5 rounds past no whole number.
std::size_t rounded(double x) { return static_cast<std::size_t>(static_cast<std::int64_t>(x + 0.5)); }

/// Far enough forward to be a sector left out; backward by a little is a tremble.
bool is_sector(double turn) { return turn > kMaxGap_cdeg && turn < kTurn_cdeg - kMaxGap_cdeg; }

}  // namespace

const char* name_of(DecodeResult result) {
  switch (result) {
    case DecodeResult::kOk: return "ok";
    case DecodeResult::kWrongLength: return "wrong_length";
    case DecodeResult::kBadBlockFlag: return "bad_block_flag";
    case DecodeResult::kBadAzimuth: return "bad_azimuth";
    case DecodeResult::kBadTimestamp: return "bad_timestamp";
    case DecodeResult::kUnknownProduct: return "unknown_product";
    case DecodeResult::kUnknownReturnMode: return "unknown_return_mode";
  }
  return "?";
}

Decoder::Decoder(const DecoderConfig& config) : config_(config), cosine_(36000 + 9000) {
  for (std::size_t i = 0; i < cosine_.size(); ++i) {
    cosine_[i] = static_cast<float>(std::cos(static_cast<double>(i) * kRadiansPerCdeg));
  }
  for (std::size_t model = 0; model < lasers_.size(); ++model) {
    const ModelTable& table = table_of(static_cast<Model>(model));
    for (std::size_t id = 0; id < static_cast<std::size_t>(table.lasers); ++id) {
      const double elevation = table.elevation_deg[id] * M_PI / 180.0;
      Laser& laser = lasers_[model][id];
      laser.cos_elevation = static_cast<float>(std::cos(elevation));
      laser.sin_elevation = static_cast<float>(std::sin(elevation));
      laser.vertical_offset_m = config.vertical_parallax ? static_cast<float>(1e-3 * table.vertical_offset_mm[id]) : 0.0F;
      laser.time_us = table.laser_us * static_cast<double>(id / static_cast<std::size_t>(table.lasers_at_once));
      laser.azimuth_cdeg = 100.0 * table.azimuth_offset_deg[id];
    }
  }
}

DecodeResult Decoder::check(std::span<const std::byte> payload, Model& model) const {
  if (payload.size() != kPacketBytes) {
    return DecodeResult::kWrongLength;
  }
  for (std::size_t block = 0; block < kBlocks; ++block) {
    if (load_le<std::uint16_t>(payload, block * kBlockBytes) != kBlockFlag) {
      return DecodeResult::kBadBlockFlag;
    }
    if (load_le<std::uint16_t>(payload, block * kBlockBytes + 2) >= 36000) {
      return DecodeResult::kBadAzimuth;
    }
  }
  if (load_le<std::uint32_t>(payload, kTimestampAt) >= kHour_us) {
    return DecodeResult::kBadTimestamp;
  }
  const auto mode = load_le<std::uint8_t>(payload, kReturnModeAt);
  const auto product = model_of_product(load_le<std::uint8_t>(payload, kProductAt));
  if (!config_.model && !product) {
    return DecodeResult::kUnknownProduct;
  }
  if (mode != kStrongest && mode != kLast && mode != kDual) {
    return DecodeResult::kUnknownReturnMode;
  }
  model = config_.model.value_or(product.value_or(Model::kVlp16));
  return DecodeResult::kOk;
}

DecodeResult Decoder::decode(std::span<const std::byte> payload, Stamp received, sensor::PointBlock& block) {
  Model model = Model::kVlp16;
  const DecodeResult result = check(payload, model);
  ++report_.packets[static_cast<std::size_t>(result)];
  if (result != DecodeResult::kOk) {
    return result;
  }
  report_.last_return_mode = load_le<std::uint8_t>(payload, kReturnModeAt);
  report_.last_product = load_le<std::uint8_t>(payload, kProductAt);
  const auto product = model_of_product(report_.last_product);
  report_.other_product += product != std::optional(model) ? 1 : 0;
  block.received = received;
  block.stamp = Stamp{};
  block.device_stamp = DeviceStamp{} + std::chrono::microseconds(load_le<std::uint32_t>(payload, kTimestampAt));
  decode_blocks(payload, model, report_.last_return_mode == kDual, block);
  return result;
}

void Decoder::read_azimuths(std::span<const std::byte> payload,
                            bool dual,
                            const ModelTable& table,
                            Turning& turning) {
  const std::size_t stride = dual ? 2 : 1;
  const std::size_t count = kBlocks / stride;
  // Until a gap is seen: ten turns a second.
  double gap = kTurn_cdeg * 10e-6 * table.sequence_us * table.sequences_per_block();
  for (std::size_t i = 0; i < count; ++i) {
    turning.azimuth_cdeg[i] = load_le<std::uint16_t>(payload, i * stride * kBlockBytes + 2);
  }
  const auto gap_after = [&](std::size_t i) { return turn_cdeg(turning.azimuth_cdeg[i], turning.azimuth_cdeg[i + 1]); };
  for (std::size_t i = 0; i + 1 < count; ++i) {
    if (gap_after(i) <= kMaxGap_cdeg) {
      gap = gap_after(i);
      break;
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (i + 1 < count && gap_after(i) <= kMaxGap_cdeg) {
      gap = gap_after(i);
    }
    turning.gap_cdeg[i] = gap;
  }
  count_cycles(table.sequence_us * table.sequences_per_block(), count, turning);
}

void Decoder::count_cycles(double cycle_us, std::size_t count, Turning& turning) {
  std::size_t sectors = 0;
  std::size_t sector_after = 0;
  double turned_cdeg = 0.0;
  std::size_t steps = 0;
  for (std::size_t i = 0; i + 1 < count; ++i) {
    turning.cycle[i + 1] = static_cast<int>(i + 1);
    const double turn = turn_cdeg(turning.azimuth_cdeg[i], turning.azimuth_cdeg[i + 1]);
    if (is_sector(turn)) {
      ++sectors;
      sector_after = i;
    } else if (turn <= kMaxGap_cdeg) {
      turned_cdeg += turn;
      ++steps;
    }
  }
  if (sectors != 1 || steps == 0) {
    return;  // azimuths that jump to and fro tell nothing about time
  }
  // The motor is set in steps of 60 rpm, from 300 on; the lasers keep their beat in the sector left out.
  const double seen_rpm = turned_cdeg / static_cast<double>(steps) / kTurn_cdeg * 60e6 / cycle_us;
  const double rpm = std::max(300.0, 60.0 * std::round(seen_rpm / 60.0));
  const double sector_cdeg = turn_cdeg(turning.azimuth_cdeg[sector_after], turning.azimuth_cdeg[sector_after + 1]);
  const auto cycles = static_cast<int>(std::lround(sector_cdeg / kTurn_cdeg * 60e6 / rpm / cycle_us));
  for (std::size_t i = sector_after + 1; i < count; ++i) {
    turning.cycle[i] += std::max(cycles, 1) - 1;
  }
}

void Decoder::decode_blocks(std::span<const std::byte> payload, Model model, bool dual, sensor::PointBlock& block) {
  const ModelTable& table = table_of(model);
  const std::array<Laser, 32>& lasers = lasers_[static_cast<std::size_t>(model)];
  Turning turning;
  read_azimuths(payload, dual, table, turning);
  const int pairs = dual ? kBlocks / 2 : kBlocks;
  block.points.clear();
  block.sequences.clear();
  block.empty_firings = 0;
  const int cycles = turning.cycle[static_cast<std::size_t>(pairs) - 1] + 1;
  block.duration = from_seconds(1e-6 * table.sequence_us * table.sequences_per_block() * cycles);
  for (int pair = 0; pair < pairs; ++pair) {
    for (int firing = 0; firing < table.sequences_per_block(); ++firing) {
      decode_sequence(payload, table, lasers, pair, firing, dual, turning, block);
    }
  }
}

void Decoder::decode_sequence(std::span<const std::byte> payload,
                              const ModelTable& table,
                              const std::array<Laser, 32>& lasers,
                              int pair,
                              int firing,
                              bool dual,
                              const Turning& turning,
                              sensor::PointBlock& out) const {
  const auto index = static_cast<std::size_t>(pair);
  const double azimuth = turning.azimuth_cdeg[index];
  const double gap = turning.gap_cdeg[index];
  const double cycle_us = table.sequence_us * table.sequences_per_block();
  const double begin_us = table.sequence_us * firing;
  const double sequence_us = cycle_us * turning.cycle[index] + begin_us;
  const double first_azimuth = std::fmod(azimuth + gap * begin_us / cycle_us, kTurn_cdeg);
  out.sequences.push_back({static_cast<std::uint16_t>(out.points.size()),
                           static_cast<std::uint16_t>(first_azimuth),
                           static_cast<std::uint32_t>(std::lround(1e3 * sequence_us))});

  const std::size_t block = index * (dual ? 2 : 1);
  for (std::size_t id = 0; id < static_cast<std::size_t>(table.lasers); ++id) {
    const Laser& laser = lasers[id];
    const std::size_t place =
        kBlockHeader + kReturnBytes * (static_cast<std::size_t>(firing * table.lasers) + id);
    const auto alpha_cdeg =
        rounded(azimuth + gap * (begin_us + laser.time_us) / cycle_us - laser.azimuth_cdeg + kTurn_cdeg) % 36000;
    const float cos_alpha = cosine_[alpha_cdeg];
    const float sin_alpha = cosine_[alpha_cdeg < 9000 ? alpha_cdeg + 27000 : alpha_cdeg - 9000];
    std::uint16_t earlier = 0;
    std::uint8_t echo = 0;
    for (std::size_t half = 0; half < (dual ? 2U : 1U); ++half) {
      const std::size_t at = (block + half) * kBlockBytes + place;
      const auto raw = load_le<std::uint16_t>(payload, at);
      if (raw == 0 || (half == 1 && raw == earlier)) {
        continue;
      }
      earlier = raw;
      const float range_m = static_cast<float>(raw * table.distance_unit_m);
      const float flat_m = range_m * laser.cos_elevation;
      sensor::Point point;
      point.x_m = flat_m * cos_alpha;
      point.y_m = -flat_m * sin_alpha;
      point.z_m = range_m * laser.sin_elevation + laser.vertical_offset_m;
      point.offset_ns = static_cast<std::uint32_t>(rounded(1e3 * (sequence_us + laser.time_us)));
      point.intensity = load_le<std::uint8_t>(payload, at + 2);
      point.line = table.ring[id];
      point.echo = echo++;
      out.points.push_back(point);
    }
    out.empty_firings += earlier == 0 ? 1 : 0;
  }
}

}  // namespace slamd::velodyne
