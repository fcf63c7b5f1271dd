#include "drivers/transport/can_socket.hpp"

#include <linux/can.h>
#include <linux/can/error.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/assert.hpp"
#include "tests/support/allocation_guard.hpp"

namespace slamd::transport {
namespace {

/// The kernel's side of a socket that brings what the test wants it to.
class Can : public testing::Test {
 protected:
  Can() {
    int ends[2];
    SLAMD_ASSERT(socketpair(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0, ends) == 0);
    kernel_ = ends[0];
    sut_ = std::make_unique<CanSocket>(ends[1], "can7", clock_);
  }
  ~Can() override { close(kernel_); }

  void bring(std::uint32_t can_id, std::initializer_list<int> data) const {
    can_frame raw{};
    raw.can_id = can_id;
    raw.can_dlc = static_cast<std::uint8_t>(data.size());
    std::copy(data.begin(), data.end(), raw.data);
    bring_bytes(&raw, sizeof raw);
  }

  void bring_bytes(const void* bytes, std::size_t size) const {
    SLAMD_ASSERT(send(kernel_, bytes, size, 0) == static_cast<ssize_t>(size));
  }

  std::vector<CanFrame> take() {
    std::vector<CanFrame> frames;
    while (sut_->receive([&](const CanFrame& frame) { frames.push_back(frame); }) > 0) {
    }
    return frames;
  }

  HostClock clock_;
  std::unique_ptr<CanSocket> sut_;
  int kernel_ = -1;
};

TEST_F(Can, HandsFramesOnInTheirOrderWithShortAndLongIds) {
  const Stamp before = clock_.now();
  bring(0x032, {1, 2, 3, 4, 5, 6});
  bring(0x08F02D80U | CAN_EFF_FLAG, {1, 2, 3, 4, 5, 6, 7, 8});

  const std::vector<CanFrame> frames = take();

  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0].id, 0x032U);
  EXPECT_FALSE(frames[0].is_extended);
  EXPECT_EQ(frames[0].bytes().size(), 6U);
  EXPECT_EQ(frames[0].data[5], std::byte{6});
  EXPECT_EQ(frames[1].id, 0x08F02D80U);
  EXPECT_TRUE(frames[1].is_extended);
  EXPECT_EQ(frames[1].bytes().size(), 8U);
  EXPECT_GE(frames[0].received, before - std::chrono::milliseconds(1));
  EXPECT_LE(frames[0].received, frames[1].received);
  EXPECT_LE(frames[1].received, clock_.now());
  EXPECT_EQ(sut_->counters().received, 2U);
}

TEST_F(Can, TakesMoreFramesThanABatchHolds) {
  std::uint32_t next = 0;
  constexpr std::uint32_t kFrames = CanSocket::kBatch + 5;
  for (std::uint32_t i = 0; i < kFrames; ++i) {
    bring(0x100 + i, {});
  }

  for (const CanFrame& frame : take()) {
    EXPECT_EQ(frame.id, 0x100 + next++);
  }

  EXPECT_EQ(next, kFrames);
}

TEST_F(Can, CountsWhatTheControllerTellsOfItself) {
  bring(CAN_ERR_FLAG | CAN_ERR_BUSOFF, {0, 0, 0, 0, 0, 0, 0, 0});
  bring(CAN_ERR_FLAG | CAN_ERR_RESTARTED, {0, 0, 0, 0, 0, 0, 0, 0});
  bring(CAN_ERR_FLAG | CAN_ERR_CRTL, {0, CAN_ERR_CRTL_RX_WARNING, 0, 0, 0, 0, 0, 0});
  bring(CAN_ERR_FLAG | CAN_ERR_CRTL, {0, CAN_ERR_CRTL_TX_PASSIVE | CAN_ERR_CRTL_RX_OVERFLOW, 0, 0, 0, 0, 0, 0});
  bring(CAN_ERR_FLAG | CAN_ERR_CRTL, {0});  // says nothing

  EXPECT_TRUE(take().empty());

  const CanCounters counters = sut_->counters();
  EXPECT_EQ(counters.bus_off, 1U);
  EXPECT_EQ(counters.restarted, 1U);
  EXPECT_EQ(counters.warnings, 1U);
  EXPECT_EQ(counters.passive, 1U);
  EXPECT_EQ(counters.controller_lost, 1U);
  EXPECT_EQ(counters.other, 0U);
}

TEST_F(Can, CountsWhatCarriesNoData) {
  can_frame overlong{};
  overlong.can_dlc = 9;
  const std::array<std::byte, 72> flexible{};
  bring(0x032U | CAN_RTR_FLAG, {});
  bring_bytes(&overlong, sizeof overlong);
  bring_bytes(flexible.data(), flexible.size());
  bring_bytes(flexible.data(), 3);

  EXPECT_TRUE(take().empty());

  EXPECT_EQ(sut_->counters().other, 4U);
  EXPECT_EQ(sut_->counters().received, 0U);
}

TEST_F(Can, DoesNotAllocate) {
  SLAMD_NEEDS_ALLOCATION_GUARD();
  bring(0x032, {1, 2, 3, 4, 5, 6});
  std::size_t seen = 0;

  const auto allocations = support::count_allocations([&] { sut_->receive([&](const CanFrame& frame) { seen += frame.size; }); });

  EXPECT_EQ(seen, 6U);
  EXPECT_EQ(allocations, 0U);
}

TEST(CanSocket, SaysInWordsThatTheKernelHasNoCan) {
  const int probe = socket(PF_CAN, SOCK_RAW, 1);
  if (probe >= 0) {
    close(probe);
    GTEST_SKIP() << "this kernel has CAN";
  }
  try {
    const CanSocket sut(CanSocketConfig{"can0", {}}, HostClock());
    FAIL() << "it opened";
  } catch (const TransportError& error) {
    EXPECT_NE(std::string(error.what()).find("CAN interface can0: this kernel has no CAN"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace slamd::transport
