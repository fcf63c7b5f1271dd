#include "tools/simulate/spinning_model.hpp"

namespace slamd::simulate {

namespace {

SpinningModel vlp16() {
  SpinningModel model;
  // Even lasers look down from −15° on, odd ones up to +15°.
  for (std::size_t laser = 0; laser < 16; ++laser) {
    model.elevation_deg[laser] = static_cast<double>(laser) - (laser % 2 == 0 ? 15.0 : 0.0);
  }
  return model;
}

SpinningModel vlp32c() {
  SpinningModel model;
  model.lasers = 32;
  model.unit_m = 0.004;
  model.group = 2;
  model.product = 0x28;
  model.elevation_deg = {-25.0,  -1.0,   -1.667, -15.639, -11.31, 0.0,   -0.667, -8.843, -7.254, 0.333, -0.333,
                         -6.148, -5.333, 1.333,  0.667,   -4.0,   -4.667, 1.667,  1.0,    -3.667, -3.333, 3.333,
                         2.333,  -2.667, -3.0,   7.0,     4.667,  -2.333, -2.0,   15.0,   10.333, -1.333};
  model.azimuth_offset_deg = {-1.4, 4.2, -1.4, 1.4, -1.4, 1.4, -4.2, 1.4, -1.4, 4.2, -1.4, 1.4, -4.2, 1.4, -4.2, 1.4,
                              -1.4, 4.2, -1.4, 4.2, -4.2, 1.4, -1.4, 1.4, -1.4, 1.4, -1.4, 4.2, -4.2, 1.4, -1.4, 1.4};
  return model;
}

SpinningModel hdl32e() {
  SpinningModel model;
  model.lasers = 32;
  model.sequence_s = 46.080e-6;
  model.laser_s = 1.152e-6;
  model.product = 0x21;
  for (std::size_t laser = 0; laser < 32; ++laser) {
    model.elevation_deg[laser] = (laser % 2 == 0 ? -30.67 : -9.33) + 4.0 / 3.0 * static_cast<double>(laser / 2);
  }
  return model;
}

}  // namespace

const SpinningModel& model_of(SpinningKind kind) {
  static const SpinningModel models[] = {vlp16(), vlp32c(), hdl32e()};
  return models[static_cast<std::size_t>(kind)];
}

}  // namespace slamd::simulate
