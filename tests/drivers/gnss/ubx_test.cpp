#include "drivers/gnss/ubx.hpp"

#include <gtest/gtest.h>

#include <chrono>

#include "receiver_bytes.hpp"

namespace slamd::gnss {
namespace {

using namespace std::chrono_literals;

NavPvt pvt_of(std::string_view hex) { return NavPvt::parse(read_ubx(from_hex(hex)).payload).value(); }

std::string encoded(const NavPvt& pvt) {
  const auto payload = pvt.bytes();
  return to_hex(write_ubx({ubx::kNav, ubx::kNavPvt, payload.view()}).view());
}

TEST(Ubx, ReadsTheGoldenThreeDimensionalFix) {
  const NavPvt pvt = pvt_of(kPvt3d);

  EXPECT_EQ(pvt.tow_ms, 276'388'600U);
  EXPECT_EQ(pvt.valid, 0x37);
  EXPECT_EQ(pvt.time_accuracy_ns, 39U);
  EXPECT_EQ(pvt.fix_type, 3);
  EXPECT_EQ(pvt.flags, 0x01);
  EXPECT_EQ(pvt.flags2, 0xEA);
  EXPECT_EQ(pvt.satellites, 21);
  EXPECT_EQ(pvt.longitude_1e7deg, 1'133'906'154);
  EXPECT_EQ(pvt.latitude_1e7deg, 230'443'813);
  EXPECT_EQ(pvt.height_mm, 15'444);
  EXPECT_EQ(pvt.height_msl_mm, 20'575);
  EXPECT_EQ(pvt.horizontal_accuracy_mm, 1460U);
  EXPECT_EQ(pvt.vertical_accuracy_mm, 2284U);
  EXPECT_EQ(pvt.velocity_north_mmps, -12);
  EXPECT_EQ(pvt.velocity_east_mmps, -3);
  EXPECT_EQ(pvt.velocity_down_mmps, -23);
  EXPECT_EQ(pvt.ground_speed_mmps, 13);
  EXPECT_EQ(pvt.heading_of_motion_1e5deg, 29'831'344);
  EXPECT_EQ(pvt.speed_accuracy_mmps, 210U);
  EXPECT_EQ(pvt.heading_accuracy_1e5deg, 18'000'000U);
  EXPECT_EQ(pvt.pdop_001, 169);
  // 2026-09-30 04:46:10.599649570; the time of the week says the same, 18 leap seconds on.
  ASSERT_TRUE(pvt.utc());
  EXPECT_EQ(pvt.utc()->time_since_epoch(), 1'790'743'570'599'649'570ns);
}

TEST(Ubx, ReadsTheOtherGoldenFixes) {
  const NavPvt timing = pvt_of(kPvtTimeOnly);
  const NavPvt m8 = pvt_of(kPvtM8);

  EXPECT_EQ(timing.fix_type, 5);
  EXPECT_EQ(timing.nano_ns, 161'937);
  EXPECT_EQ(timing.satellites, 30);
  EXPECT_EQ(timing.latitude_1e7deg, 137'318'437);
  EXPECT_EQ(timing.pdop_001, 9999);
  EXPECT_EQ(m8.longitude_1e7deg, 71'585'350);
  EXPECT_EQ(m8.latitude_1e7deg, 512'786'942);
  EXPECT_EQ(m8.height_mm, 236'035);
  EXPECT_EQ(m8.heading_of_motion_1e5deg, 13'237'603);
  EXPECT_EQ(m8.satellites, 15);
  EXPECT_EQ(m8.utc()->time_since_epoch(), 1'571'312'768'000'080'430ns);
}

TEST(Ubx, WritesTheGoldenFramesByteForByte) {
  for (const std::string_view frame : {kPvt3d, kPvtTimeOnly, kPvtM8}) {
    EXPECT_EQ(encoded(pvt_of(frame)), frame);
  }
  EXPECT_EQ(to_hex(write_ubx({ubx::kNav, ubx::kNavPvt, {}}).view()), kPvtPoll);
}

TEST(Ubx, FindsEachFlippedBit) {
  const Bytes good = from_hex(kPvt3d);
  ASSERT_TRUE(ubx_checksum_holds(good));
  for (std::size_t i = 2; i < good.size(); ++i) {
    Bytes bad = good;
    bad[i] ^= std::byte{0x10};
    EXPECT_FALSE(ubx_checksum_holds(bad)) << i;
  }
}

TEST(Ubx, ReadsTheShortPayloadOfAnOldReceiverAndNoOther) {
  const Bytes frame = from_hex(kPvt3d);
  const auto payload = read_ubx(frame).payload;

  for (std::size_t size = 0; size <= payload.size(); ++size) {
    EXPECT_EQ(NavPvt::parse(payload.first(size)).has_value(), size == 84 || size == 92) << size;
  }
  EXPECT_EQ(NavPvt::parse(payload.first(84))->bytes().size(), 84U);
}

TEST(Ubx, KnowsNoTimeThatCannotBe) {
  const NavPvt good = pvt_of(kPvt3d);
  const auto utc_with = [&](auto change) {
    NavPvt pvt = good;
    change(pvt);
    return pvt.utc();
  };

  EXPECT_FALSE(utc_with([](NavPvt& p) { p.valid = 1; }));
  EXPECT_FALSE(utc_with([](NavPvt& p) { p.valid = 2; }));
  EXPECT_FALSE(utc_with([](NavPvt& p) { p.month = 13; }));
  EXPECT_FALSE(utc_with([](NavPvt& p) { p.month = 2; }));  // the 30th
  EXPECT_FALSE(utc_with([](NavPvt& p) { p.hour = 24; }));
  EXPECT_FALSE(utc_with([](NavPvt& p) { p.second = 61; }));
  EXPECT_FALSE(utc_with([](NavPvt& p) { p.nano_ns = 1'000'000'001; }));
  EXPECT_FALSE(utc_with([](NavPvt& p) { p.year = 0; }));
  // The receiver's nanoseconds may lie before its second.
  EXPECT_EQ(*utc_with([](NavPvt& p) { p.nano_ns = -1; }), *utc_with([](NavPvt& p) { p.nano_ns = 0; }) - 1ns);
}

}  // namespace
}  // namespace slamd::gnss
