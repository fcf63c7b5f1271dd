#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "core/base/fixed_vector.hpp"
#include "drivers/livox/control_frame.hpp"
#include "drivers/livox/sdk1_messages.hpp"

namespace slamd::livox {

/// An address and a port, in host order.
struct Endpoint {
  std::uint32_t address = 0;
  std::uint16_t port = 0;

  bool operator==(const Endpoint&) const = default;
};

inline constexpr std::uint32_t kEverybody = 0xFFFFFFFF;  // 255.255.255.255

/// What a host tells of its device.
enum class HostEventKind : std::uint8_t {
  kFound,            // looks for a host, or has answered
  kWrongSubnet,      // is there, but this host's address is of another subnet
  kHeldByOther,      // belongs to another host; value: its address, where it is known
  kNotSeen,          // does not look for a host
  kNoAnswer,         // was found, but does not answer
  kConnected,        // is this host's
  kIdentified,       // value: firmware, its first number in the highest byte
  kInitialising,     // value: %
  kStateChanged,     // value: its work state, as the protocol counts
  kStatusChanged,    // value: its status code
  kExtrinsicRead,    // see extrinsic
  kCommandFailed,    // command was refused (value: why) or not answered (value: kNoResult)
  kTimeSet,
  kSampling,
  kStopped,
  kLost,             // was this host's, and is silent
  kRestarted,        // was this host's, and looks for a host again
  kSyncChanged,      // SDK2; value: 0 none, 1 PTP, 2 GPS
  kHealthChanged,    // SDK2; value: the first health code that is not 0; 0: all is well again
  kNoData,           // says that it samples, but nothing arrives; it is set again
  kTakenOver,        // SDK2: sent to another host until now; value: its address
};

inline constexpr std::uint32_t kNoResult = 0xFFFFFFFF;

/// Something that a user, or whoever uses the samples, should know of.
struct HostEvent {
  HostEventKind kind = HostEventKind::kFound;
  DeviceCode device;
  std::uint32_t address = 0;  // the device's
  std::uint32_t value = 0;
  const char* command = "";  // kCommandFailed: what was wanted, in words
  Sdk1Extrinsic extrinsic{};  // kExtrinsicRead: as the device has it stored
};

/// Says an event in words, on one line.
std::string words_for(const HostEvent& event);

struct HostCounters {
  std::array<std::uint64_t, kFrameResults> frames{};  // by FrameResult
  std::uint64_t strangers = 0;   // good frames of others than the device
  std::uint64_t unexpected = 0;  // answers to what was not asked, of the wrong length, or that contradict themselves
};

/// What a host wants done after it was given bytes or time: datagrams to be sent, and news.
struct HostOutput {
  struct Datagram {
    std::uint16_t from_port = 0;  // of this host
    Endpoint to;
    FrameBytes bytes;
  };

  FixedVector<Datagram, 8> datagrams;
  FixedVector<HostEvent, 16> events;  // more at once are left out

  void clear() {
    datagrams.clear();
    events.clear();
  }
};

}  // namespace slamd::livox
