#include "drivers/livox/sdk2_setup.hpp"

namespace slamd::livox {

namespace {

constexpr std::uint16_t kStateDevicePort = 56200;
constexpr std::uint16_t kPointDevicePort = 56300;
constexpr std::uint16_t kImuDevicePort = 56400;

/// Indexed by Sdk2Step.
constexpr const char* kWords[] = {"send its data here",         "set the type of the points", "set the scan pattern",
                                  "switch the inertial sensor", "send points",                "change the work mode"};

}  // namespace

Sdk2Step after(Sdk2Step step) { return static_cast<Sdk2Step>(static_cast<int>(step) + 1); }

Sdk2Step wanted_from(Sdk2Step step, const Sdk2HostConfig& config) {
  return step == Sdk2Step::kScanPattern && !config.scan_pattern ? Sdk2Step::kImu : step;
}

bool is_needed(Sdk2Step step) { return step == Sdk2Step::kDestinations || step == Sdk2Step::kWorkMode; }

Sdk2ValueWriter values_of(Sdk2Step step, const Sdk2HostConfig& config, std::uint32_t host_address, std::uint8_t work_mode) {
  Sdk2ValueWriter values;
  const auto add_destination = [&](Sdk2Key key, std::uint16_t host_port, std::uint16_t device_port) {
    values.add(key, Sdk2Destination{host_address, host_port, device_port}.bytes().view());
  };
  switch (step) {
    case Sdk2Step::kDestinations:
      add_destination(Sdk2Key::kStateDestination, config.state_port, kStateDevicePort);
      add_destination(Sdk2Key::kPointDestination, config.point_port, kPointDevicePort);
      add_destination(Sdk2Key::kImuDestination, config.imu_port, kImuDevicePort);
      break;
    case Sdk2Step::kPointType:
      values.add(Sdk2Key::kPointType, config.point_type);
      break;
    case Sdk2Step::kScanPattern:
      values.add(Sdk2Key::kScanPattern, *config.scan_pattern);
      break;
    case Sdk2Step::kImu:
      values.add(Sdk2Key::kImuEnable, std::uint8_t{config.imu});
      break;
    case Sdk2Step::kPointSend:
      values.add(Sdk2Key::kPointSend, std::uint8_t{0});
      break;
    case Sdk2Step::kWorkMode:
      values.add(Sdk2Key::kWorkMode, work_mode);
      break;
    case Sdk2Step::kDone:
      break;
  }
  return values;
}

const char* words_of(Sdk2Step step) { return kWords[static_cast<std::size_t>(step)]; }

}  // namespace slamd::livox
