#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/base/stamp.hpp"
#include "drivers/livox/host_event.hpp"

namespace slamd::livox {

/// An address of this host, and the subnet that is reached from it.
struct HostInterface {
  std::uint32_t address = 0;  // host order
  std::uint32_t netmask = 0xFFFFFF00;

  bool operator==(const HostInterface&) const = default;
};

using HostInterfaces = FixedVector<HostInterface, 8>;

/// What is to be done about a command.
enum class Patience : std::uint8_t { kWait, kAskAgain, kGiveUp };

/// A host's conversation with one device, whichever the protocol: whom it is with, which command waits for its answer
/// and since when, when the device was last heard, and what was told of that.
/// Real-time: never allocates; one thread.
class Conversation {
 public:
  static constexpr Duration kNotSeenAfter = std::chrono::seconds{5};
  static constexpr int kTries = 3;

  struct Config {
    DeviceCode wanted;  // empty: anyone
    HostInterfaces interfaces;
    std::uint32_t last_number = 0;  // of a command; 1 comes after it
    Duration answer_wait{};
    Duration lost_after{};
  };

  explicit Conversation(const Config& config) : config_(config) {}

  /// Calls take(frame) for each frame of a datagram, as parse(bytes, frame, size) finds them: real devices put several
  /// answers into one.
  template <typename Frame, typename Parse, typename Take>
  void read(std::span<const std::byte> datagram, Parse parse, Take take) {
    do {
      Frame frame;
      std::size_t size = 0;
      const FrameResult result = parse(datagram, frame, size);
      ++counters_.frames[static_cast<std::size_t>(result)];
      if (result != FrameResult::kOk) {
        return;
      }
      take(frame);
      datagram = datagram.subspan(size);
    } while (!datagram.empty());
  }

  void set_interfaces(const HostInterfaces& interfaces) { config_.interfaces = interfaces; }

  bool wants(const DeviceCode& code) const { return config_.wanted == DeviceCode{} || config_.wanted == code; }
  bool is_with(Endpoint from) const { return from.address == device_.address; }
  Endpoint device() const { return device_; }
  const DeviceCode& code() const { return code_; }

  /// This host's address, as the device sees it.
  std::uint32_t host_address() const { return host_address_; }

  /// Begins with a device. Errors: false when it is of none of this host's subnets, which is told once.
  bool meet(const DeviceCode& code, Endpoint device, HostOutput& out);

  /// Gives the next command its number, never 0.
  std::uint32_t next_number() { return number_ = number_ == config_.last_number ? 1 : number_ + 1; }

  /// From now on this command's answer is waited for.
  void expect(std::uint32_t number, Stamp now);

  /// No answer is waited for any more.
  void settle() { expected_ = 0; }

  /// The next command is a new one, not a repetition.
  void begin() { tries_ = 0; }

  bool is_waiting() const { return expected_ != 0; }
  bool answers(std::uint32_t number) const { return expected_ != 0 && expected_ == number; }

  /// Tells whether it is time for a command again; what is to be done about an unanswered one.
  bool is_due(Stamp now) const { return now >= again_; }
  Patience patience(Stamp now) const;
  void be_due_at(Stamp stamp) { again_ = stamp; }

  void hear(Stamp now) { heard_ = now; }
  bool is_silent(Stamp now) const { return now - heard_ > config_.lost_after; }

  /// Looks for a device from now on.
  void search();

  /// Lets time pass in search of a device: tells once after kNotSeenAfter that there is none.
  void look(Stamp now, HostOutput& out);

  /// Puts a command on its way, from a port of this host's.
  static void send(const FrameBytes& bytes, std::uint16_t from_port, Endpoint to, HostOutput& out);

  /// Tells something of the device.
  void tell(HostEventKind kind, HostOutput& out, std::uint32_t value = 0, const char* command = "") const;
  void tell_extrinsic(const Sdk1Extrinsic& extrinsic, HostOutput& out) const;

  void count_stranger() { ++counters_.strangers; }
  void count_unexpected() { ++counters_.unexpected; }
  const HostCounters& counters() const { return counters_; }

 private:
  Config config_;
  Endpoint device_;
  DeviceCode code_;
  std::uint32_t host_address_ = 0;
  std::uint32_t number_ = 0;
  std::uint32_t expected_ = 0;  // the command whose answer is waited for; 0: none
  int tries_ = 0;
  Stamp again_{};
  Stamp heard_{};
  std::optional<Stamp> searching_since_;
  std::optional<DeviceCode> told_wrong_subnet_;
  bool told_not_seen_ = false;
  HostCounters counters_;
};

}  // namespace slamd::livox
