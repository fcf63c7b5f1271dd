#pragma once

#include <array>
#include <cstdint>

namespace slamd::simulate {

enum class SpinningKind { kVlp16, kVlp32c, kHdl32e };

/// What tells one Velodyne from another; written down here once more, so that the decoder's tables are tested and not
/// merely repeated.  Source: Velodyne manuals as collected in the protocol description, sections 1 to 4.
struct SpinningModel {
  int lasers = 16;
  double unit_m = 0.002;
  double sequence_s = 55.296e-6;
  double laser_s = 2.304e-6;  // between groups
  int group = 1;              // lasers that fire together
  std::uint8_t product = 0x22;
  std::array<double, 32> elevation_deg{};
  std::array<double, 32> azimuth_offset_deg{};  // the true azimuth is the encoder's less this

  int sequences_per_block() const { return 32 / lasers; }
};

const SpinningModel& model_of(SpinningKind kind);

}  // namespace slamd::simulate
