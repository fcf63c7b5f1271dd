#include "drivers/livox/sdk1_setup.hpp"

namespace slamd::livox {

namespace {

/// Indexed by Sdk1Step.
constexpr Sdk1Command kCommands[] = {Sdk1Command::kDeviceInfo,    Sdk1Command::kCoordinate,
                                     Sdk1Command::kSetReturnMode, Sdk1Command::kSetImuRate,
                                     Sdk1Command::kGetExtrinsic,  Sdk1Command::kSampling};

bool wanted(Sdk1Step step, const Sdk1HostConfig& config) {
  switch (step) {
    case Sdk1Step::kReturnMode:
      return config.return_mode.has_value();
    case Sdk1Step::kExtrinsic:
      return config.read_extrinsic;
    default:
      return true;
  }
}

}  // namespace

Sdk1Step after(Sdk1Step step) { return static_cast<Sdk1Step>(static_cast<int>(step) + 1); }

Sdk1Step wanted_from(Sdk1Step step, const Sdk1HostConfig& config) {
  while (step != Sdk1Step::kDone && !wanted(step, config)) {
    step = after(step);
  }
  return step;
}

Sdk1Command command_of(Sdk1Step step) { return kCommands[static_cast<std::size_t>(step)]; }

Payload payload_of(Sdk1Step step, const Sdk1HostConfig& config) {
  switch (step) {
    case Sdk1Step::kCoordinate:
      return one_byte(config.coordinate);
    case Sdk1Step::kReturnMode:
      return one_byte(*config.return_mode);
    case Sdk1Step::kImuRate:
      return one_byte(config.imu ? 1 : 0);
    case Sdk1Step::kStart:
      return one_byte(1);
    default:
      return {};
  }
}

const char* words_of(Sdk1Command command) {
  switch (command) {
    case Sdk1Command::kDeviceInfo:
      return "tell the firmware";
    case Sdk1Command::kCoordinate:
      return "set the coordinates";
    case Sdk1Command::kSetReturnMode:
      return "set the return mode";
    case Sdk1Command::kSetImuRate:
      return "set the inertial sensor's rate";
    case Sdk1Command::kGetExtrinsic:
      return "tell the extrinsic";
    case Sdk1Command::kSampling:
      return "start sampling";
    case Sdk1Command::kSetMode:
      return "change the mode";
    case Sdk1Command::kSetUtc:
      return "take the time";
    default:
      return "do what it was told";
  }
}

}  // namespace slamd::livox
