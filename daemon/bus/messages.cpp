#include "daemon/bus/messages.hpp"

#include <charconv>
#include <cmath>
#include <optional>

namespace slamd::bus {

namespace {

std::optional<double> number_in(std::string_view text) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

}  // namespace

const char* name_of(State state) {
  switch (state) {
    case State::kStarting: return "STARTING";
    case State::kTracking: return "TRACKING";
    case State::kDegraded: return "DEGRADED";
    case State::kLost: return "LOST";
    case State::kRelocalising: return "RELOCALISING";
  }
  return "?";
}

const char* name_of(Cause cause) {
  switch (cause) {
    case Cause::kNone: return "none";
    case Cause::kAligning: return "aligning";
    case Cause::kNoImu: return "no imu";
    case Cause::kImuGap: return "imu gap";
    case Cause::kFewConstraints: return "few constraints";
    case Cause::kFewInliers: return "few inliers";
    case Cause::kLargeInnovation: return "large innovation";
    case Cause::kDegenerate: return "degenerate";
    case Cause::kSaturated: return "saturated";
    case Cause::kUnconfirmed: return "unconfirmed";
    case Cause::kMapRestarted: return "map restarted";
    case Cause::kNoLidar: return "no lidar";
  }
  return "?";
}

const char* name_of(Correction cause) {
  switch (cause) {
    case Correction::kStart: return "start";
    case Correction::kLoop: return "loop";
    case Correction::kGnss: return "gnss";
    case Correction::kRelocalisation: return "relocalisation";
    case Correction::kCommand: return "command";
  }
  return "?";
}

const char* name_of(SensorState state) {
  switch (state) {
    case SensorState::kNotConfigured: return "not configured";
    case SensorState::kWaiting: return "waiting";
    case SensorState::kRunning: return "running";
    case SensorState::kSilent: return "silent";
    case SensorState::kFaulty: return "faulty";
  }
  return "?";
}

const char* name_of(TimeState state) {
  switch (state) {
    case TimeState::kUnknown: return "unknown";
    case TimeState::kAcquiring: return "acquiring";
    case TimeState::kLocked: return "locked";
    case TimeState::kShared: return "shared";
    case TimeState::kStepped: return "stepped";
  }
  return "?";
}

namespace {

/// A name that stays inside its folder, whatever becomes of it.
bool is_plain_name(const std::string& name) {
  return name[0] != '.' && name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-") == std::string::npos;
}

}  // namespace

std::string fault_of(const Command& command) {
  const Verb* verb = nullptr;
  for (const Verb& known : kVerbs) {
    verb = known.name == command.verb ? &known : verb;
  }
  if (verb == nullptr) {
    return "unknown command '" + command.verb.substr(0, 40) + "'";
  }
  if (command.arguments.size() != verb->arguments) {
    return command.verb + " takes " + std::to_string(verb->arguments) + " arguments, not " +
           std::to_string(command.arguments.size());
  }
  for (const std::string& argument : command.arguments) {
    if (argument.empty() || argument.size() > Command::kMaxArgument_bytes) {
      return command.verb + ": an argument has 1 to " + std::to_string(Command::kMaxArgument_bytes) + " bytes";
    }
    if (command.verb == "save" && !is_plain_name(argument)) {
      return "save: a name has letters, digits, '.', '_' and '-' only, and does not begin with '.'";
    }
    if (command.verb == "set-pose" && !number_in(argument)) {
      return "set-pose: '" + argument.substr(0, 40) + "' is no number";
    }
  }
  return {};
}

}  // namespace slamd::bus
