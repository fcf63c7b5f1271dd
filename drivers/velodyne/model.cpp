#include "drivers/velodyne/model.hpp"

#include <algorithm>

namespace slamd::velodyne {

namespace {

constexpr double kVlp16Elevations[16] = {-15, 1, -13, 3, -11, 5, -9, 7, -7, 9, -5, 11, -3, 13, -1, 15};
constexpr double kVlp16Offsets[16] = {11.2, -0.7, 9.7, -2.2, 8.1, -3.7, 6.6, -5.1,
                                      5.1,  -6.6, 3.7, -8.1, 2.2, -9.7, 0.7, -11.2};
constexpr double kHiResElevations[16] = {-10,    0.667,  -8.667, 2,      -7.333, 3.333,  -6,     4.667,
                                         -4.667, 6,      -3.333, 7.333,  -2,     8.667,  -0.667, 10};
constexpr double kVlp32cElevations[32] = {-25,    -1,    -1.667, -15.639, -11.31, 0,     -0.667, -8.843,
                                          -7.254, 0.333, -0.333, -6.148,  -5.333, 1.333, 0.667,  -4,
                                          -4.667, 1.667, 1,      -3.667,  -3.333, 3.333, 2.333,  -2.667,
                                          -3,     7,     4.667,  -2.333,  -2,     15,    10.333, -1.333};
constexpr double kVlp32cAzimuths[32] = {-1.4, 4.2, -1.4, 1.4,  -1.4, 1.4, -4.2, 1.4,  -1.4, 4.2, -1.4,
                                        1.4,  -4.2, 1.4, -4.2, 1.4,  -1.4, 4.2, -1.4, 4.2,  -4.2, 1.4,
                                        -1.4, 1.4,  -1.4, 1.4, -1.4, 4.2,  -4.2, 1.4, -1.4, 1.4};

void rank_rings(ModelTable& table) {
  for (int laser = 0; laser < table.lasers; ++laser) {
    const auto lower = std::count_if(table.elevation_deg.begin(), table.elevation_deg.begin() + table.lasers,
                                     [&](double other) { return other < table.elevation_deg[static_cast<std::size_t>(laser)]; });
    table.ring[static_cast<std::size_t>(laser)] = static_cast<std::uint8_t>(lower);
  }
}

ModelTable vlp16(const double (&elevations)[16]) {
  ModelTable table;
  std::copy(std::begin(elevations), std::end(elevations), table.elevation_deg.begin());
  if (&elevations == &kVlp16Elevations) {
    std::copy(std::begin(kVlp16Offsets), std::end(kVlp16Offsets), table.vertical_offset_mm.begin());
  }
  rank_rings(table);
  return table;
}

ModelTable vlp32c() {
  ModelTable table;
  table.lasers = 32;
  table.distance_unit_m = 0.004;
  table.lasers_at_once = 2;
  std::copy(std::begin(kVlp32cElevations), std::end(kVlp32cElevations), table.elevation_deg.begin());
  std::copy(std::begin(kVlp32cAzimuths), std::end(kVlp32cAzimuths), table.azimuth_offset_deg.begin());
  rank_rings(table);
  return table;
}

ModelTable hdl32e() {
  ModelTable table;
  table.lasers = 32;
  table.sequence_us = 46.080;
  table.laser_us = 1.152;
  for (std::size_t laser = 0; laser < 32; ++laser) {
    const double first = laser % 2 == 0 ? -30.67 : -9.33;
    table.elevation_deg[laser] = first + 4.0 / 3.0 * static_cast<double>(laser / 2);
  }
  rank_rings(table);
  return table;
}

}  // namespace

const char* name_of(Model model) {
  switch (model) {
    case Model::kVlp16: return "VLP-16";
    case Model::kVlp16HiRes: return "Puck Hi-Res";
    case Model::kVlp32c: return "VLP-32C";
    case Model::kHdl32e: return "HDL-32E";
  }
  return "?";
}

const ModelTable& table_of(Model model) {
  static const ModelTable tables[] = {vlp16(kVlp16Elevations), vlp16(kHiResElevations), vlp32c(), hdl32e()};
  return tables[static_cast<std::size_t>(model)];
}

std::optional<Model> model_of_product(std::uint8_t product) {
  switch (product) {
    case 0x21: return Model::kHdl32e;
    case 0x22: return Model::kVlp16;
    case 0x24: return Model::kVlp16HiRes;
    case 0x28: return Model::kVlp32c;
    default: return std::nullopt;
  }
}

}  // namespace slamd::velodyne
