#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/sensor/point_block.hpp"
#include "drivers/velodyne/model.hpp"

namespace slamd::velodyne {

/// What became of a data packet.
enum class DecodeResult : std::uint8_t {
  kOk,
  kWrongLength,
  kBadBlockFlag,
  kBadAzimuth,
  kBadTimestamp,
  kUnknownProduct,
  kUnknownReturnMode,
};

inline constexpr std::size_t kDecodeResults = 7;

const char* name_of(DecodeResult result);

struct DecoderConfig {
  std::optional<Model> model;      // given: whatever the product byte says (firmware of 2014 has odd ones)
  bool vertical_parallax = false;
};

/// What the packets have said about the device.
struct DecoderReport {
  std::array<std::uint64_t, kDecodeResults> packets{};
  std::uint64_t other_product = 0;  // packets whose product byte is not the configured model's
  std::uint8_t last_product = 0;
  std::uint8_t last_return_mode = 0;

  std::uint64_t of(DecodeResult result) const { return packets[static_cast<std::size_t>(result)]; }
};

/// Decodes Velodyne data packets: VLP-16, Puck Hi-Res, VLP-32C and HDL-32E, one or two returns.
///
/// Each return gets its laser's own firing time and interpolated azimuth. Dual mode: the stronger and the last return
/// share a firing's time; where they are the same one, it comes once. A sensor that is told to leave a sector out
/// fills one packet a turn on both sides of it: the blocks behind come later by the time that the head needs.
/// Frames: lidar, x = R cos ω cos α, y = −R cos ω sin α, z = R sin ω.
/// Errors: a refused packet changes nothing but its counter.
/// Real-time: allocates in the constructor only; O(returns).
class Decoder {
 public:
  static constexpr std::size_t kPacketBytes = 1206;

  explicit Decoder(const DecoderConfig& config);

  /// Decodes a packet into `block`: device stamp (since the top of the hour), points and firing sequences.
  DecodeResult decode(std::span<const std::byte> payload, Stamp received, sensor::PointBlock& block);

  const DecoderReport& report() const { return report_; }

 private:
  struct Laser {
    float cos_elevation = 1.0F;
    float sin_elevation = 0.0F;
    float vertical_offset_m = 0.0F;
    double time_us = 0.0;        // from the sequence's first laser
    double azimuth_cdeg = 0.0;   // offset to be subtracted
  };

  /// The azimuths of a packet: of each block, and how far the head turns from each to the next.
  struct Turning {
    std::array<std::uint16_t, 12> azimuth_cdeg{};
    std::array<double, 12> gap_cdeg{};
    std::array<int, 12> cycle{};  // how many blocks' times after the first: beyond its index behind a sector left out
  };

  static void count_cycles(double cycle_us, std::size_t count, Turning& turning);
  DecodeResult check(std::span<const std::byte> payload, Model& model) const;
  static void read_azimuths(std::span<const std::byte> payload, bool dual, const ModelTable& table, Turning& turning);
  void decode_blocks(std::span<const std::byte> payload, Model model, bool dual, sensor::PointBlock& block);
  void decode_sequence(std::span<const std::byte> payload,
                       const ModelTable& table,
                       const std::array<Laser, 32>& lasers,
                       int pair,
                       int firing,
                       bool dual,
                       const Turning& turning,
                       sensor::PointBlock& out) const;

  DecoderConfig config_;
  DecoderReport report_;
  std::array<std::array<Laser, 32>, 4> lasers_{};  // by model and laser id
  std::vector<float> cosine_;                      // by hundredth of a degree; a quarter turn longer than a turn
};

}  // namespace slamd::velodyne
