#include "tools/sensors/remarks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "daemon/configuration/loader.hpp"
#include "made_seen.hpp"
#include "tools/sensors/json.hpp"
#include "tools/sensors/table.hpp"

namespace slamd::sensors {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string words_for(const Seen& seen, const std::string& toml = "") {
  std::optional<configuration::Configuration> configuration;
  if (!toml.empty()) {
    configuration::Loader loader;
    loader.add_text(toml, "test.toml");
    configuration = loader.load();
  }
  return remarks_as_lines(remarks_of(seen, configuration));
}

TEST(Remarks, SayNothingWhereAllIsWell) {
  Seen seen = made_seen();
  seen.lidars = {made_avia()};
  seen.lines = {made_xsens(), made_receiver()};

  EXPECT_EQ(words_for(seen), "nothing to remark\n");
}

TEST(Remarks, SayWhatToLookAtWhereNothingIsHeard) {
  Seen seen = made_seen();
  seen.listened_s = 1.0;
  EXPECT_EQ(words_for(seen), "nothing to remark\n");

  seen.listened_s = 4.0;
  EXPECT_THAT(words_for(seen), testing::HasSubstr("! network: nothing is heard at all: are sensors powered"));
}

TEST(Remarks, NameTheSubnetsWhenASensorIsOfAnotherOne) {
  Seen seen = made_seen();
  seen.lidars = {made_avia()};
  seen.lidars[0].address = 0xC0A80132;

  EXPECT_THAT(words_for(seen), HasSubstr("! Livox Avia 3JEDK380010Z391 at 192.168.1.50: is of another subnet than this host, which has 10.77.0.1/24"));
}

TEST(Remarks, NameWhoHasAPort) {
  Seen seen = made_seen();
  seen.ports = {{.port = 2368, .purpose = "points of a Velodyne", .owner = "slamd (pid 12)", .beside = {}, .buffer = {}, .datagrams = {}, .strange = {}}};

  EXPECT_THAT(words_for(seen), HasSubstr("! UDP port 2368: is taken by slamd (pid 12): points of a Velodyne are not heard here"));
}

TEST(Remarks, SayOnceThatReceiveBuffersAreSmall) {
  Seen seen = made_seen();
  seen.listened_s = 1.0;
  const std::string small = ": receive buffer of 212992 bytes instead of 4194304 (sysctl net.core.rmem_max=4194304 ...)";
  seen.ports = {{.port = 2368, .purpose = {}, .owner = {}, .beside = {}, .buffer = "UDP port 2368" + small, .datagrams = {}, .strange = {}},
                {.port = 8308, .purpose = {}, .owner = {}, .beside = {}, .buffer = "UDP port 8308" + small, .datagrams = {}, .strange = {}}};

  EXPECT_EQ(words_for(seen), "! receive buffers" + small + "\n");
}

TEST(Remarks, CountWhatIsNoSensors) {
  Seen seen = made_seen();
  seen.ports = {{.port = 2368, .purpose = {}, .owner = {}, .beside = {}, .buffer = {}, .datagrams = {9, 9}, .strange = {7, 7}, .stranger = 0x0A4D0003}};

  EXPECT_THAT(words_for(seen), HasSubstr("7 datagrams are no sensor's that is known, the last one of 10.77.0.3"));
}

TEST(Remarks, SayThatAVelodyneHearsNoPps) {
  Seen seen = made_seen();
  seen.lidars = {made_vlp16()};
  EXPECT_THAT(words_for(seen), HasSubstr("sends no position packets"));

  seen.lidars[0].pps = velodyne::PpsState::kNone;
  EXPECT_THAT(words_for(seen), HasSubstr("hears no PPS"));

  seen.lidars[0].pps = velodyne::PpsState::kLocked;
  EXPECT_THAT(words_for(seen), HasSubstr("no sentence"));

  seen.lidars[0].sentence = "$GPRMC";
  EXPECT_EQ(words_for(seen), "nothing to remark\n");
}

TEST(Remarks, SayThatALivoxFollowsNoClock) {
  Seen seen = made_seen();
  seen.lidars = {made_avia()};
  seen.lidars[0].packets = {100, 100};
  seen.lidars[0].time = TimeSource::kFreeRunning;
  EXPECT_THAT(words_for(seen), HasSubstr("follows no clock, neither PTP nor PPS"));

  seen.lidars[0].status = livox::StatusCode{.pps_present = true};
  EXPECT_THAT(words_for(seen), HasSubstr("lidar.device.set_utc"));

  seen.lidars[0].time = TimeSource::kPtp;
  EXPECT_EQ(words_for(seen), "nothing to remark\n");
}

TEST(Remarks, SayWhenAnAviaHasAHost) {
  Seen seen = made_seen();
  seen.lidars = {made_avia()};
  seen.lidars[0].silent_s = 4.0;
  EXPECT_THAT(words_for(seen), HasSubstr("looks for no host any more: another host owns it, or it is off"));

  seen.lidars[0].packets = {100, 100};  // it sends here: somebody here has set it up
  EXPECT_EQ(words_for(seen), "nothing to remark\n");
}

TEST(Remarks, NameTheProgramOfThisComputerThatMayHaveTheAvia) {
  Seen seen = made_seen();
  seen.lidars = {made_avia()};
  seen.lidars[0].silent_s = 4.0;
  seen.ports = {{.port = 55000, .purpose = {}, .owner = {}, .beside = "slamd (pid 12)", .buffer = {}, .datagrams = {}, .strange = {}}};

  EXPECT_THAT(words_for(seen), HasSubstr("it belongs to slamd (pid 12) on this computer"));
}

TEST(Remarks, SayWhatAnAviaAnswers) {
  Seen seen = made_seen();
  seen.avias = {{kSensor, AviaAnswer::kRefusal, ""}};
  EXPECT_THAT(words_for(seen), HasSubstr("! Livox SDK1 device at 10.77.0.2: refuses this host: another one owns it"));

  seen.avias[0].answer = AviaAnswer::kNone;
  EXPECT_THAT(words_for(seen), HasSubstr("does not answer"));

  seen.avias[0] = {kSensor, AviaAnswer::kNotAsked, "slamd (pid 3) on this computer has it"};
  EXPECT_THAT(words_for(seen), HasSubstr("is not asked: slamd (pid 3) on this computer has it"));
}

TEST(Remarks, SayThatOtherSubnetsAreNotHeardOnlyWhereNothingElseIs) {
  Seen seen = made_seen();
  seen.hears_wire = false;
  EXPECT_THAT(words_for(seen), HasSubstr("CAP_NET_RAW"));

  seen.lidars = {made_avia()};
  EXPECT_EQ(words_for(seen), "nothing to remark\n");
}

TEST(Remarks, NameTheHostThatAMid360SendsTo) {
  Seen seen = made_seen();
  seen.lidars = {made_mid360()};
  seen.lidars[0].sends_to = 0xC0A80105;
  EXPECT_THAT(words_for(seen), HasSubstr("is set to send to another host, 192.168.1.5"));

  seen.lidars[0].sends_to = kHost;
  EXPECT_EQ(words_for(seen), "nothing to remark\n");

  seen.lidars[0].sends_to = 0;
  EXPECT_EQ(words_for(seen), "nothing to remark\n");
}

TEST(Remarks, SayThatSamplesAreInG) {
  Seen seen = made_seen();
  seen.lines = {made_xsens()};
  seen.lines[0].imu.units = imu::Units::kInG;

  EXPECT_THAT(words_for(seen), HasSubstr("! /dev/ttyUSB0: specific force looks like g"));
}

constexpr const char* kSideways = R"(
[[lidar]]
model = "vlp16"
[imu]
source = "serial"
device = "/dev/ttyUSB0"
T_base_imu = { xyz_m = [0, 0, 0], rpy_deg = [90, 0, 0] }
)";

TEST(Remarks, SayWhereGravityIsWhenTheExtrinsicHasItElsewhere) {
  Seen seen = made_seen();
  seen.lines = {made_xsens()};

  EXPECT_THAT(words_for(seen, kSideways), HasSubstr("gravity is 90.0 degrees from where imu.T_base_imu has it"));
  EXPECT_THAT(words_for(seen, kSideways), HasSubstr("rpy_deg = [0.0, 0.0, 0.0] would have it there"));
}

TEST(Remarks, SayNothingOfGravityWhereItIsRightOrNotToBeJudged) {
  Seen seen = made_seen();
  seen.lines = {made_xsens()};
  seen.lines[0].imu.mean_force_mps2 = {0.0, 9.81, 0.0};
  EXPECT_EQ(words_for(seen, kSideways), "nothing to remark\n");

  seen.lines[0].imu.mean_force_mps2 = {0.0, 0.0, 9.81};
  seen.lines[0].imu.mean_rate_radps = {0.0, 0.0, 1.0};
  EXPECT_EQ(words_for(seen, kSideways), "nothing to remark\n");

  seen.lines[0].imu.mean_rate_radps.setZero();
  seen.lines[0].device = "/dev/ttyUSB1";  // another sensor than the configured one
  EXPECT_EQ(words_for(seen, kSideways), "nothing to remark\n");
}

TEST(Remarks, JudgeRowsFromTheNetworkByTheirPort) {
  Seen seen = made_seen();
  seen.rows = {{kSensor, 7501, made_xsens().imu}};
  const std::string toml = "[[lidar]]\nmodel = \"vlp16\"\n[imu]\nsource = \"udp\"\nT_base_imu = { xyz_m = [0, 0, 0], rpy_deg = [0, 45, 0] }\n";

  EXPECT_THAT(words_for(seen, toml), HasSubstr("! CSV rows of 10.77.0.2: gravity is 45.0 degrees from where imu.T_base_imu has it"));
  EXPECT_EQ(words_for(seen, toml + "port = 7502\n"), "nothing to remark\n");
}

TEST(Remarks, JudgeALivoxByThePlaceOfItsPoints) {
  Seen seen = made_seen();
  seen.lidars = {made_mid360()};
  seen.lidars[0].imu = made_xsens().imu;

  const std::string words = words_for(seen, "[[lidar]]\nmodel = \"livox_mid360\"\nT_base_lidar = { xyz_m = [0, 0, 0], rpy_deg = [180, 0, 0] }\n[imu]\nsource = \"livox\"\n");

  EXPECT_THAT(words, HasSubstr("gravity is 180.0 degrees from where lidar.T_base_lidar has it"));
}

TEST(Remarks, SayWhatASerialLineLacks) {
  Seen seen = made_seen();
  LineSeen line;
  line.device = "/dev/ttyUSB3";
  line.rounds = 1;
  seen.lines = {line};
  EXPECT_THAT(words_for(seen), HasSubstr("says nothing at any rate: a sensor that waits to be asked shows itself with --ask"));

  seen.asked = true;
  EXPECT_THAT(words_for(seen), Not(HasSubstr("--ask")));

  seen.lines[0].bytes = {100, 10};
  EXPECT_THAT(words_for(seen), HasSubstr("nothing that is known"));

  seen.lines[0].trouble = "is held by slamd (pid 3), and left to it";
  EXPECT_THAT(words_for(seen), HasSubstr("! /dev/ttyUSB3: is held by slamd (pid 3)"));

  seen.lines = {made_receiver()};
  seen.lines[0].gnss.good = {};
  seen.lines[0].gnss.lacks = "no_fix";
  EXPECT_THAT(words_for(seen), HasSubstr("has no good fix: no_fix, 11 satellites"));
}

TEST(Remarks, SayThatASensorSendsNoInertialData) {
  Seen seen = made_seen();
  seen.lines = {made_xsens()};
  seen.lines[0].imu = {};

  EXPECT_THAT(words_for(seen), HasSubstr("none with acceleration, turn rate and time"));
}

TEST(Remarks, SayWhatABusLacks) {
  Seen seen = made_seen();
  BusSeen bus;
  bus.interface = "can0";
  seen.buses = {bus};
  EXPECT_THAT(words_for(seen), HasSubstr("! can0: carries no frames"));

  seen.buses[0].trouble = "is down";
  seen.buses[0].bus_off = 2;
  EXPECT_THAT(words_for(seen), HasSubstr("! can0: is down"));
  EXPECT_THAT(words_for(seen), HasSubstr("was off the bus 2 times"));
}

TEST(Table, ShowsEachSensorWithWhatCameInTheLastSecond) {
  Seen seen = made_seen();
  seen.lidars = {made_vlp16()};
  seen.lines = {made_xsens(), made_receiver()};

  const std::string text = draw(seen, {}, {24, 120});

  EXPECT_THAT(text, HasSubstr("Velodyne VLP-16  10.77.0.2"));
  EXPECT_THAT(text, HasSubstr("754 packets/s"));
  EXPECT_THAT(text, HasSubstr("115200 baud, 100 samples/s, 9.81 m/s^2, up is +z"));
  EXPECT_THAT(text, HasSubstr("5 good fixes/s, 11 satellites"));
}

TEST(Table, KeepsWithinTheTerminal) {
  Seen seen = made_seen();
  for (int i = 0; i < 40; ++i) {
    seen.lidars.push_back(made_avia());
  }
  const std::vector<Remark> remarks(10, {"somebody", std::string(300, 'x') + " " + std::string(300, 'y')});

  std::istringstream text(draw(seen, remarks, {30, 70}));

  int lines = 0;
  for (std::string line; std::getline(text, line); ++lines) {
    EXPECT_LE(line.size(), 70U) << line;
  }
  EXPECT_EQ(lines, 30);
}

TEST(Table, SaysThatNothingIsHeard) {
  EXPECT_THAT(draw(made_seen(), {}, {}), HasSubstr("nothing heard yet"));
  EXPECT_THAT(second_as_lines(made_seen()), HasSubstr("nothing heard"));
}

TEST(Json, IsOneLineWithEverything) {
  Seen seen = made_seen();
  seen.lidars = {made_vlp16(), made_avia(), made_mid360()};
  seen.lines = {made_xsens(), made_receiver()};
  BusSeen bus;
  bus.interface = "can0";
  bus.ids = {{0x1A0, false, 8, {100, 50}}};
  seen.buses = {bus};

  const std::string text = to_json(seen, {{"somebody", "says \"x\"\n"}});

  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1);
  for (const char* part : {R"("model":"vlp16")", R"("code":"3JEDK380010Z391")", R"("speaks":"gnss")", R"("id":416)", R"("about":"somebody")",
                           R"("packets":{"total":7540,"last_second":754})"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
}

}  // namespace
}  // namespace slamd::sensors
