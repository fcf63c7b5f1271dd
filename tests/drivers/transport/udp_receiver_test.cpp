#include "drivers/transport/udp_receiver.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <numeric>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/assert.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::transport {
namespace {

constexpr const char* kSensor = "127.0.0.1";
constexpr const char* kStranger = "127.0.0.2";  // all of 127.0.0.0/8 is this host

/// Sends numbered datagrams from an address of the loopback.
class Sender {
 public:
  Sender(std::uint16_t port, const char* from = kSensor) : fd_(socket(AF_INET, SOCK_DGRAM, 0)) {
    sockaddr_in own{};
    own.sin_family = AF_INET;
    own.sin_addr.s_addr = inet_addr(from);
    SLAMD_ASSERT(bind(fd_, reinterpret_cast<const sockaddr*>(&own), sizeof own) == 0);
    to_.sin_family = AF_INET;
    to_.sin_port = htons(port);
    to_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  }
  ~Sender() { close(fd_); }
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;

  void send(std::uint32_t number, std::size_t bytes = 1206) {
    std::vector<std::byte> payload(bytes);
    if (bytes >= sizeof number) {
      std::memcpy(payload.data(), &number, sizeof number);
    }
    const auto sent = sendto(fd_, payload.data(), bytes, 0, reinterpret_cast<const sockaddr*>(&to_), sizeof to_);
    SLAMD_ASSERT(sent == static_cast<ssize_t>(bytes));
  }

 private:
  int fd_;
  sockaddr_in to_{};
};

std::uint32_t number_of(const Datagram& datagram) {
  std::uint32_t number = 0;
  std::memcpy(&number, datagram.payload.data(), sizeof number);
  return number;
}

/// Receives until nothing waits.
std::vector<std::uint32_t> drain(UdpReceiver& receiver) {
  std::vector<std::uint32_t> numbers;
  while (receiver.receive([&](const Datagram& datagram) { numbers.push_back(number_of(datagram)); }) > 0) {
  }
  return numbers;
}

UdpReceiverConfig any_port() {
  UdpReceiverConfig config;
  config.bind_address = "127.0.0.1";
  return config;
}

std::uint64_t sum(const UdpCounters& counters) {
  return counters.received + counters.foreign_source + counters.truncated + counters.kernel_lost;
}

template <typename Action>
std::string refusal_of(Action&& action) {
  try {
    action();
  } catch (const TransportError& error) {
    return error.what();
  }
  return "";
}

TEST(UdpReceiver, HandsOutEachDatagramInOrderWithItsSender) {
  UdpReceiver sut(any_port(), HostClock());
  Sender sender(sut.port());
  for (std::uint32_t i = 0; i < 100; ++i) {
    sender.send(i);
  }

  std::vector<std::uint32_t> numbers;
  while (sut.receive([&](const Datagram& datagram) {
    numbers.push_back(number_of(datagram));
    EXPECT_EQ(datagram.payload.size(), 1206U);
    EXPECT_EQ(datagram.source_address, 0x7F000001U);
    EXPECT_NE(datagram.source_port, 0);
    EXPECT_EQ(datagram.destination_port, sut.port());
  }) > 0) {
  }

  std::vector<std::uint32_t> expected(100);
  std::iota(expected.begin(), expected.end(), 0U);
  EXPECT_EQ(numbers, expected);
  EXPECT_EQ(sut.counters().received, 100U);
}

TEST(UdpReceiver, ReturnsZeroWhenNothingWaits) {
  UdpReceiver sut(any_port(), HostClock());

  EXPECT_EQ(sut.receive([](const Datagram&) { FAIL(); }), 0U);
}

TEST(UdpReceiver, StampsWithTheTimeOfArrivalAndNotOfReading) {
  const HostClock clock;
  UdpReceiver sut(any_port(), clock);
  Sender sender(sut.port());
  sender.send(0);  // the kernel begins to stamp a little after it is asked to
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  drain(sut);

  const Stamp before = clock.now();
  sender.send(1);
  const Stamp after = clock.now();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));

  Stamp received{};
  sut.receive([&](const Datagram& datagram) { received = datagram.received; });
  EXPECT_GE(received, before - std::chrono::microseconds(100));
  EXPECT_LE(received, after + std::chrono::microseconds(100));
}

Duration wall_clock_step{};

ClockReadings stepped_clocks() {
  ClockReadings readings = read_clocks();
  readings.realtime += wall_clock_step;
  return readings;
}

TEST(UdpReceiver, KeepsItsStampsBetweenTheLastOneAndNowWhileTheWallClockSteps) {
  // The datagrams' stamps are those from before the step, the readings those from after it.
  for (const Duration step : {Duration(std::chrono::hours(1)), Duration(std::chrono::hours(-1))}) {
    wall_clock_step = Duration(0);
    const HostClock clock(&stepped_clocks);
    UdpReceiver sut(any_port(), clock);
    Sender sender(sut.port());
    sender.send(0);
    Stamp last{};
    sut.receive([&](const Datagram& datagram) { last = datagram.received; });
    sender.send(1);

    wall_clock_step = step;
    Stamp received{};
    sut.receive([&](const Datagram& datagram) { received = datagram.received; });

    EXPECT_GE(received, last);
    EXPECT_LE(received, clock.now());
    EXPECT_LT(received - last, std::chrono::seconds(10));
  }
}

TEST(UdpReceiver, CountsExactlyWhatTheKernelDropsFromAFullBuffer) {
  UdpReceiverConfig config = any_port();
  config.receive_buffer_bytes = 8192;
  UdpReceiver sut(config, HostClock());
  Sender sender(sut.port());
  constexpr std::uint32_t kSent = 1000;

  std::size_t received = 0;
  for (std::uint32_t i = 0; i < kSent; ++i) {
    sender.send(i);
    if (i % 100 == 50) {
      received += drain(sut).size();
    }
  }
  received += drain(sut).size();

  EXPECT_GT(sut.counters().kernel_lost, 100U);
  EXPECT_GT(received, 10U);
  EXPECT_EQ(received, sut.counters().received);
  EXPECT_EQ(sum(sut.counters()), kSent);
}

TEST(UdpReceiver, NeverTakesALossBack) {
  UdpReceiverConfig config = any_port();
  config.receive_buffer_bytes = 8192;
  UdpReceiver sut(config, HostClock());
  Sender sender(sut.port());
  std::uint64_t lost = 0;

  for (int round = 0; round < 2; ++round) {
    for (std::uint32_t i = 0; i < 100; ++i) {
      sender.send(i);
    }
    while (sut.receive([&](const Datagram&) {  // the second round's were queued between losses that are known by now
      EXPECT_GE(sut.counters().kernel_lost, lost);
      lost = sut.counters().kernel_lost;
    }) > 0) {
    }
  }

  EXPECT_GT(lost, 100U);
  EXPECT_LT(lost, 200U);
}

TEST(UdpReceiver, TellsOfLossesWhileItIsStillBehind) {
  UdpReceiverConfig config = any_port();
  config.receive_buffer_bytes = 256 << 10;
  UdpReceiver sut(config, HostClock());
  Sender sender(sut.port());
  for (std::uint32_t i = 0; i < 1000; ++i) {  // several times what the buffer holds
    sender.send(i);
  }
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(sut.receive([](const Datagram&) {}), UdpReceiver::kBatch);
  }
  ASSERT_EQ(sut.counters().kernel_lost, 0U);
  for (std::uint32_t i = 0; i < 3 * UdpReceiver::kBatch; ++i) {
    sender.send(i);
  }

  std::size_t taken = UdpReceiver::kBatch;
  while (taken == UdpReceiver::kBatch && sut.counters().kernel_lost == 0) {
    taken = sut.receive([](const Datagram&) {});
  }

  EXPECT_EQ(taken, UdpReceiver::kBatch);  // more was waiting
  EXPECT_GT(sut.counters().kernel_lost, 500U);
}

TEST(UdpReceiver, ListensToAnyoneUntilItIsPinned) {
  UdpReceiver sut(any_port(), HostClock());
  Sender sensor(sut.port()), stranger(sut.port(), kStranger);
  stranger.send(1);
  sensor.send(2);
  stranger.send(3);
  sensor.send(4);

  std::vector<std::uint32_t> numbers;
  sut.receive([&](const Datagram& datagram) {
    numbers.push_back(number_of(datagram));
    if (number_of(datagram) == 2) {
      sut.pin(datagram.source_address);  // takes effect within the batch
    }
  });

  EXPECT_EQ(numbers, (std::vector<std::uint32_t>{1, 2, 4}));
  EXPECT_EQ(sut.pinned(), std::optional(0x7F000001U));
  EXPECT_EQ(sut.counters().foreign_source, 1U);
}

TEST(UdpReceiver, ListensToAnyoneAgainAfterUnpin) {
  UdpReceiver sut(any_port(), HostClock());
  Sender stranger(sut.port(), kStranger);
  sut.pin(0x7F000001U);

  sut.unpin();
  stranger.send(7);

  EXPECT_EQ(drain(sut), std::vector<std::uint32_t>{7});
}

TEST(UdpReceiver, TakesTheConfiguredSourceOnlyWhateverIsPinned) {
  UdpReceiverConfig config = any_port();
  config.source_address = kSensor;
  UdpReceiver sut(config, HostClock());
  Sender sensor(sut.port()), stranger(sut.port(), kStranger);

  sut.pin(0x7F000002U);
  sut.unpin();
  stranger.send(1);
  sensor.send(2);

  EXPECT_EQ(drain(sut), std::vector<std::uint32_t>{2});
  EXPECT_EQ(sut.counters().foreign_source, 1U);
}

TEST(UdpReceiver, CountsDatagramsThatAreTooLong) {
  UdpReceiver sut(any_port(), HostClock());
  Sender sender(sut.port());
  sender.send(1, UdpReceiver::kMaxPayloadBytes + 1);
  sender.send(2, UdpReceiver::kMaxPayloadBytes);

  EXPECT_EQ(drain(sut), std::vector<std::uint32_t>{2});
  EXPECT_EQ(sut.counters().truncated, 1U);
  EXPECT_EQ(sum(sut.counters()), 2U);
}

TEST(UdpReceiver, HandsOutEmptyDatagrams) {
  UdpReceiver sut(any_port(), HostClock());
  Sender sender(sut.port());
  sender.send(0, 0);

  std::size_t visits = 0;
  sut.receive([&](const Datagram& datagram) {
    ++visits;
    EXPECT_TRUE(datagram.payload.empty());
  });

  EXPECT_EQ(visits, 1U);
}

TEST(UdpReceiver, NamesTheProcessThatHasThePort) {
  const UdpReceiver owner(any_port(), HostClock());
  UdpReceiverConfig config = any_port();
  config.port = owner.port();

  const std::string sut = refusal_of([&] { UdpReceiver second(config, HostClock()); });

  EXPECT_EQ(sut.find("UDP port " + std::to_string(owner.port()) + " is taken by test_drivers"), 0U) << sut;
  EXPECT_NE(sut.find("(pid " + std::to_string(getpid()) + ")"), std::string::npos) << sut;
}

TEST(UdpReceiver, SaysWhatIsWrongWithAnAddress) {
  UdpReceiverConfig config;
  config.bind_address = "192.0.2.1";  // for documents only: nobody's
  config.port = 2368;
  EXPECT_EQ(refusal_of([&] { UdpReceiver sut(config, HostClock()); }),
            "UDP port 2368 cannot be bound: no interface of this host has the address 192.0.2.1");

  config.bind_address = "lidar";
  EXPECT_EQ(refusal_of([&] { UdpReceiver sut(config, HostClock()); }),
            "UDP port 2368 cannot be bound to \"lidar\": no IPv4 address");

  config.bind_address = "127.0.0.1";
  config.source_address = "1.2.3";
  EXPECT_EQ(refusal_of([&] { UdpReceiver sut(config, HostClock()); }),
            "UDP port 2368 cannot listen to \"1.2.3\": no IPv4 address");
}

TEST(UdpReceiver, SaysWhenItsBufferIsSmallerThanAskedFor) {
  UdpReceiverConfig config = any_port();
  config.receive_buffer_bytes = 65'536;
  EXPECT_EQ(UdpReceiver(config, HostClock()).buffer_remark(), "");
  EXPECT_EQ(UdpReceiver(config, HostClock()).receive_buffer_bytes(), 65'536);

  config.receive_buffer_bytes = 1'500'000'000;  // more than the kernel gives to anyone
  const UdpReceiver sut(config, HostClock());

  EXPECT_LT(sut.receive_buffer_bytes(), config.receive_buffer_bytes);
  EXPECT_NE(sut.buffer_remark().find("instead of 1500000000"), std::string::npos) << sut.buffer_remark();
}

TEST(UdpReceiver, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  UdpReceiver sut(any_port(), HostClock());
  Sender sender(sut.port()), stranger(sut.port(), kStranger);
  for (std::uint32_t i = 0; i < 50; ++i) {
    sender.send(i);
    stranger.send(i, 3000);
  }

  const std::size_t allocations = support::count_allocations([&] {
    while (sut.receive([&](const Datagram& datagram) { sut.pin(datagram.source_address); }) > 0) {
    }
  });

  EXPECT_EQ(allocations, 0U);
  EXPECT_EQ(sum(sut.counters()), 100U);
}

TEST(UdpReceiver, ShowsItsCountersToAnotherThread) {
  UdpReceiver sut(any_port(), HostClock());
  std::atomic<bool> done = false;
  std::uint64_t seen = 0;
  std::thread health([&] {
    while (!done) {
      const std::uint64_t now = sum(sut.counters());
      EXPECT_GE(now, seen);
      seen = now;
    }
    seen = sum(sut.counters());
  });
  Sender sender(sut.port());

  for (std::uint32_t i = 0; i < 2000; ++i) {
    sender.send(i);
    drain(sut);
  }
  done = true;
  health.join();

  EXPECT_EQ(seen, 2000U);
}

TEST(Address, ReadsBackAsItIsWritten) {
  EXPECT_EQ(parse_address("192.168.1.201"), std::optional(0xC0A801C9U));
  EXPECT_EQ(dotted(0xC0A801C9U), "192.168.1.201");
  EXPECT_EQ(parse_address("192.168.1"), std::nullopt);
  EXPECT_EQ(parse_address(""), std::nullopt);
}

}  // namespace
}  // namespace slamd::transport
