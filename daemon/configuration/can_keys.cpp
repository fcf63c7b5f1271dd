#include "daemon/configuration/can_keys.hpp"

#include "daemon/configuration/key_makers.hpp"

namespace slamd::configuration {

using can::CanSignal;
using can::WheelModel;

namespace {

using Signal = std::optional<CanSignal> WheelConfiguration::*;

/// Makes a key of a signal one that is not printed while the signal is not configured.
Key of_signal(Key key, Signal signal) {
  key.optional = true;
  key.get = [get = std::move(key.get), signal](const Configuration& c) {
    return (c.wheel.*signal).has_value() ? get(c) : Value(std::vector<double>());
  };
  return key;
}

/// The keys of one signal: what a line of a DBC file says.
void add_signal(std::vector<Key>& keys, const std::string& path, const std::string& what, Signal signal) {
  const auto edit = [signal](Configuration& c) -> CanSignal& {
    std::optional<CanSignal>& edited = c.wheel.*signal;
    return edited ? *edited : edited.emplace();
  };
  const auto add = [&](Key key) {
    key.help = what + key.help;
    keys.push_back(of_signal(std::move(key), signal));
  };
  add(keys::number(path + ".id", 0, 0x1FFF'FFFF, ": the id of its frames.", [edit](Configuration& c) -> auto& { return edit(c).id; }));
  add(keys::boolean(path + ".extended", ": ids of 29 bits.", [edit](Configuration& c) -> auto& { return edit(c).is_extended; }));
  add(keys::choice<bool>(path + ".byte_order", {{"little", false}, {"big", true}}, ": little is Intel's (@1 in a DBC), big is Motorola's (@0).", [edit](Configuration& c) -> auto& { return edit(c).is_big_endian; }));
  add(keys::number(path + ".first_bit", 0, 63, ", as a DBC counts: the lowest bit, or in big byte order the highest.", [edit](Configuration& c) -> auto& { return edit(c).first_bit; }));
  add(keys::number(path + ".bits", 1, 64, ": how many.", [edit](Configuration& c) -> auto& { return edit(c).bits; }));
  add(keys::boolean(path + ".signed", ": may be below zero.", [edit](Configuration& c) -> auto& { return edit(c).is_signed; }));
  add(keys::number(path + ".scale", -1e6, 1e6, " is scale · raw + offset.", [edit](Configuration& c) -> auto& { return edit(c).scale; }));
  add(keys::number(path + ".offset", -1e6, 1e6, ": see scale.", [edit](Configuration& c) -> auto& { return edit(c).offset; }));
}

}  // namespace

#define SLAMD_FIELD(member) [](Configuration& c) -> auto& { return c.member; }

void add_imu_can_keys(std::vector<Key>& keys) {
  keys.push_back(keys::text("imu.interface", "\"can\": the interface, such as can0. Of a log: frames of this one only; empty: of all.", SLAMD_FIELD(imu.interface)));
  keys.push_back(keys::text("imu.axis_map", "\"aceinna\": the axes in their order on the wire, with '-' where turned round: \"y,x,z\" is J1939's.", SLAMD_FIELD(imu.axis_map)));
  keys.push_back(keys::number("imu.can_address", -1, 253, "\"aceinna\": the sensor's address on the bus (as delivered 128); -1: whichever speaks.", SLAMD_FIELD(imu.can_address)));
}

void add_wheel_can_keys(std::vector<Key>& keys) {
  keys.push_back(keys::text("wheel.interface", "As imu.interface.", SLAMD_FIELD(wheel.interface)));
  keys.push_back(keys::choice<WheelModel>("wheel.model", {{"differential", WheelModel::kDifferential}, {"ackermann", WheelModel::kAckermann}}, "On CAN: left and right speed, or speed and steering angle.", SLAMD_FIELD(wheel.model)));
  keys.push_back(keys::number("wheel.track_m", 0.05, 20.0, "Differential: between the left and the right wheels.", SLAMD_FIELD(wheel.track_m)));
  keys.push_back(keys::number("wheel.wheelbase_m", 0.05, 30.0, "Ackermann: between the axles; base lies on the rear one.", SLAMD_FIELD(wheel.wheelbase_m)));
  add_signal(keys, "wheel.left", "Differential, speed of the left wheels in m/s", &WheelConfiguration::left);
  add_signal(keys, "wheel.right", "Differential, speed of the right wheels in m/s", &WheelConfiguration::right);
  add_signal(keys, "wheel.speed", "Ackermann, speed in m/s", &WheelConfiguration::speed);
  add_signal(keys, "wheel.steering", "Ackermann, angle of the front wheels in rad, left is positive", &WheelConfiguration::steering);
}

#undef SLAMD_FIELD

}  // namespace slamd::configuration
