#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "drivers/livox/host_event.hpp"
#include "tests/hex/hex.hpp"

namespace slamd::livox {

/// The wire between a host under test and a scripted device, and the time. A device has answer(datagram), and may_be_sent
/// an address: what the host sends elsewhere is a failure.
template <typename Host, typename Device>
class HostWire : public testing::Test {
 protected:
  using Bytes = hex::Bytes;

  HostWire(Host sut, Endpoint answers_from) : sut_(std::move(sut)), answers_from_(answers_from) {}

  /// What the device does by itself.
  virtual void device_advances() {}

  /// Lets the time pass in steps of 50 ms.
  void run(Duration duration) {
    const Stamp end = now_ + duration;
    while (now_ < end) {
      now_ += std::chrono::milliseconds{50};
      device_advances();
      sut_.advance(now_, out_);
      deliver();
    }
  }

  void give(const Bytes& bytes, Endpoint from) {
    sut_.receive(bytes, from, now_, out_);
    deliver();
  }

  /// Carries datagrams to and fro until nobody has anything to say.
  void deliver() {
    while (true) {
      events_.insert(events_.end(), out_.events.begin(), out_.events.end());
      std::vector<Bytes> sent;
      for (const auto& datagram : out_.datagrams) {
        EXPECT_TRUE(datagram.to == answers_from_ || datagram.to.address == kEverybody);
        EXPECT_NE(datagram.from_port, 0);
        sent.emplace_back(datagram.bytes.begin(), datagram.bytes.end());
      }
      out_.clear();
      if (sent.empty()) {
        return;
      }
      for (const Bytes& bytes : sent) {
        if (const auto answer = device_.answer(bytes)) {
          sut_.receive(*answer, answers_from_, now_, out_);
        }
      }
    }
  }

  std::size_t told(HostEventKind kind) const {
    return static_cast<std::size_t>(
        std::count_if(events_.begin(), events_.end(), [&](const HostEvent& event) { return event.kind == kind; }));
  }

  /// The words of the last event of a kind; none: empty.
  std::string last_words(HostEventKind kind) const {
    const auto found = std::find_if(events_.rbegin(), events_.rend(), [&](const HostEvent& e) { return e.kind == kind; });
    return found == events_.rend() ? "" : words_for(*found);
  }

  Host sut_;
  Endpoint answers_from_;
  Device device_;
  HostOutput out_;
  std::vector<HostEvent> events_;
  Stamp now_{std::chrono::seconds{1000}};
};

}  // namespace slamd::livox
