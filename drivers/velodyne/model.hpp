#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace slamd::velodyne {

enum class Model : std::uint8_t { kVlp16, kVlp16HiRes, kVlp32c, kHdl32e };

const char* name_of(Model model);

/// What tells one model's packets from another's.
/// Source: Velodyne manuals as collected in the protocol description, sections 1 to 4.
struct ModelTable {
  int lasers = 16;
  double distance_unit_m = 0.002;
  double sequence_us = 55.296;               // one firing sequence, with recharge
  int lasers_at_once = 1;                    // fired together
  double laser_us = 2.304;                   // between (groups of) lasers
  std::array<double, 32> elevation_deg{};    // by laser id
  std::array<double, 32> azimuth_offset_deg{};  // subtracted from the encoder's azimuth
  std::array<double, 32> vertical_offset_mm{};  // parallax, applied on request
  std::array<std::uint8_t, 32> ring{};       // rank of the elevation, lowest first

  int sequences_per_block() const { return 32 / lasers; }
};

const ModelTable& table_of(Model model);

/// Returns the model of a packet's product byte, or nothing when it is none of those.
std::optional<Model> model_of_product(std::uint8_t product);

}  // namespace slamd::velodyne
