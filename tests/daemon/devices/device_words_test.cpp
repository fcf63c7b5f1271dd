#include "daemon/devices/device_words.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>

namespace slamd::devices {
namespace {

using livox::HostEvent;
using livox::HostEventKind;

HostEvent event(HostEventKind kind, std::uint32_t value = 0, const char* command = "") {
  return {kind, livox::DeviceCode::of("3JEDK380010Z391"), 0xC0A80170, value, command};
}

TEST(DeviceWords, SayNothingOfADeviceThatSamplesAndIsWell) {
  DeviceWords sut;
  sut.take(event(HostEventKind::kStatusChanged, 0x00006000));  // synchronised by PTP

  EXPECT_EQ(sut.cause(true, "sampling"), "");
}

TEST(DeviceWords, SayWhatTheHostIsAtWhenThereIsNothingElse) {
  EXPECT_EQ(DeviceWords{}.cause(false, "searching"), "searching");
}

TEST(DeviceWords, SayWhatKeepsADeviceFromSampling) {
  const std::pair<HostEvent, const char*> cases[] = {
      {event(HostEventKind::kNotSeen), "not to be heard: off, of another subnet, or another host's"},
      {event(HostEventKind::kWrongSubnet), "192.168.1.112 is of another subnet than this host"},
      {event(HostEventKind::kHeldByOther), "held by another host"},
      {event(HostEventKind::kHeldByOther, 0xC0A80109), "held by another host, 192.168.1.9"},
      {event(HostEventKind::kNoAnswer), "found, but does not answer"},
      {event(HostEventKind::kInitialising, 42), "initialises, 42 %"},
      {event(HostEventKind::kCommandFailed, 1, "start sampling"), "refuses to start sampling"},
      {event(HostEventKind::kCommandFailed, livox::kNoResult, "start sampling"), "does not answer: start sampling"},
      {event(HostEventKind::kNoData), "samples, but nothing arrives"},
      {event(HostEventKind::kLost), "lost, looked for again"},
      {event(HostEventKind::kRestarted), "has restarted"}};
  for (const auto& [news, words] : cases) {
    DeviceWords sut;
    sut.take(news);

    EXPECT_EQ(sut.cause(false, "searching"), words);
    EXPECT_LE(std::string("livox_mid360: ").size() + sut.cause(false, "searching").size(), 79U) << words;
  }
}

TEST(DeviceWords, ForgetWhatWasOnceTheDeviceIsFoundOrSamples) {
  for (const HostEventKind kind : {HostEventKind::kFound, HostEventKind::kConnected, HostEventKind::kSampling}) {
    DeviceWords sut;
    sut.take(event(HostEventKind::kLost));

    sut.take(event(kind));

    EXPECT_EQ(sut.cause(false, "configuring"), "configuring");
  }
}

TEST(DeviceWords, KnowWhyADeviceOfAnotherHostIsNotToBeHeard) {
  DeviceWords sut;
  sut.take(event(HostEventKind::kHeldByOther));

  sut.take(event(HostEventKind::kNotSeen));

  EXPECT_EQ(sut.cause(false, "searching"), "held by another host");
  sut.take(event(HostEventKind::kFound));
  sut.take(event(HostEventKind::kNotSeen));
  EXPECT_NE(sut.cause(false, "searching"), "held by another host");
}

TEST(DeviceWords, SayThatADeviceFollowsNoClockWhereItShould) {
  for (const HostEvent& none : {event(HostEventKind::kStatusChanged, 0), event(HostEventKind::kSyncChanged, 0)}) {
    DeviceWords alone;
    DeviceWords shared(true);
    alone.take(none);
    shared.take(none);
    EXPECT_EQ(alone.cause(true, "sampling"), "");
    EXPECT_EQ(shared.cause(true, "sampling"), "follows no clock, though lidar.clock is \"shared\"");

    shared.take(event(none.kind, none.kind == HostEventKind::kSyncChanged ? 1 : 0x00006000));

    EXPECT_EQ(shared.cause(true, "sampling"), "");
  }
}

TEST(DeviceWords, SayWhatADeviceLacksThatIsToldTheTime) {
  DeviceWords sut(false, true);
  const auto says = [&](std::uint32_t status) {
    sut.take(event(HostEventKind::kStatusChanged, status));
    return sut.cause(true, "sampling");
  };

  EXPECT_EQ(sut.cause(true, "sampling"), "hears no PPS, and so cannot use the UTC that it is told");
  EXPECT_EQ(says(0x00000200), "hears PPS, but does not follow it yet");
  EXPECT_EQ(says(0x0000C200), "follows PPS, but has taken no UTC yet");
  EXPECT_EQ(says(0x00008200), "");  // PPS and UTC
  EXPECT_EQ(says(0x00000000), "hears no PPS, and so cannot use the UTC that it is told");
  EXPECT_EQ(says(0x00006000), "");  // PTP goes before
  EXPECT_EQ(says(0x00010200), "time synchronisation abnormal");
}

TEST(DeviceWords, KeepWhatIsWrongWithADeviceWhileItSamples) {
  DeviceWords sut;
  sut.take(event(HostEventKind::kStatusChanged, 0x40000001));
  EXPECT_NE(sut.cause(true, "sampling").find("temperature"), std::string::npos) << sut.cause(true, "sampling");

  sut.take(event(HostEventKind::kStatusChanged, 0));
  EXPECT_EQ(sut.cause(true, "sampling"), "");
  sut.take(event(HostEventKind::kHealthChanged, 42));
  EXPECT_EQ(sut.cause(true, "sampling"), "reports health code 42");
  sut.take(event(HostEventKind::kLost));
  EXPECT_EQ(sut.cause(false, "searching"), "lost, looked for again");
}

}  // namespace
}  // namespace slamd::devices
