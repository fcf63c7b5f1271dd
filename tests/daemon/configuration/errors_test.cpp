#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "daemon/configuration/loader.hpp"
#include "tests/scratch/scratch_folder.hpp"

namespace slamd::configuration {
namespace {

using scratch::message_of;

/// What loading a file of this text, and then overrides, is refused with.
std::string refusal_of(const std::string& toml, const std::vector<std::string>& overrides = {}) {
  return message_of<ConfigurationError>([&] {
    Loader sut;
    sut.add_text(toml, "robot.toml");
    for (const std::string& key_value : overrides) {
      sut.add_override(key_value);
    }
    sut.load();
  });
}

struct Broken {
  const char* name;
  const char* toml;
  const char* refusal;  // the whole line
};

void PrintTo(const Broken& broken, std::ostream* stream) { *stream << broken.name; }

class BrokenFile : public testing::TestWithParam<Broken> {};

TEST_P(BrokenFile, IsRefusedInOneLineWithFileLineKeyValueAndWhatIsAllowed) {
  const std::string refusal = refusal_of(GetParam().toml);

  EXPECT_EQ(refusal, GetParam().refusal);
  EXPECT_EQ(refusal.find('\n'), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(
    All,
    BrokenFile,
    testing::Values(
        Broken{"MisspeltKey", "[[lidar]]\nmodel = \"vlp16\"\n\n[odometry]\nfliter = \"psf\"\n",
               "robot.toml:5: odometry.fliter = 'psf': unknown key; did you mean odometry.filter?"},
        Broken{"KeyLikeNoOther", "[[lidar]]\nmodel = \"vlp16\"\nwhatever_this_is_supposed_to_be = 3\n",
               "robot.toml:3: lidar.whatever_this_is_supposed_to_be = 3: unknown key; docs/configuration.md lists them"},
        Broken{"MisspeltTable", "[[lidar]]\nmodel = \"vlp16\"\n[odometri]\nseed = 2\n",
               "robot.toml:4: odometri.seed = 2: unknown key; did you mean odometry.seed?"},
        Broken{"EmptyUnknownTable", "[[lidar]]\nmodel = \"vlp16\"\n[camera]\n",
               "robot.toml:3: camera = {}: unknown key; docs/configuration.md lists them"},
        Broken{"TableInAKeysPlace", "[[lidar]]\nmodel = \"vlp16\"\n[odometry.seed]\n",
               "robot.toml:3: odometry.seed = {}: must be a whole number from 0 to 1000000000"},
        Broken{"ValueInATablesPlace", "[[lidar]]\nmodel = \"vlp16\"\n[odometry]\n[map]\n[gnss]\nT_base_antenna = 4\n",
               "robot.toml:6: gnss.T_base_antenna = 4: must be a table of xyz_m, rpy_deg"},
        Broken{"TextForANumber", "[[lidar]]\nmodel = \"vlp16\"\nmax_range_m = \"far\"\n",
               "robot.toml:3: lidar.max_range_m = 'far': must be a number from 1 to 1000"},
        Broken{"NumberWithAUnit", "[[lidar]]\nmodel = \"vlp16\"\nmax_range_m = \"90 m\"\n",
               "robot.toml:3: lidar.max_range_m = '90 m': must be a number from 1 to 1000"},
        Broken{"NumberForAText", "[[lidar]]\nmodel = \"vlp16\"\nsource = 5\n",
               "robot.toml:3: lidar.source = 5: must be a text in quotes"},
        Broken{"SpaceInAName", "[[lidar]]\nmodel = \"vlp16\"\n[lcm]\nprefix = \"robot 2\"\n",
               "robot.toml:4: lcm.prefix = 'robot 2': must be 1 to 40 letters, digits, '_' or '-', in quotes"},
        Broken{"EmptyName", "[[lidar]]\nmodel = \"vlp16\"\n[lcm]\nprefix = \"\"\n",
               "robot.toml:4: lcm.prefix = '': must be 1 to 40 letters, digits, '_' or '-', in quotes"},
        Broken{"NameTooLong", "[[lidar]]\nmodel = \"vlp16\"\n[lcm]\nprefix = \"a2345678901234567890123456789012345678901\"\n",
               "robot.toml:4: lcm.prefix = 'a2345678901234567890123456789012345678901': must be 1 to 40 letters, digits, "
               "'_' or '-', in quotes"},
        Broken{"NumberForAFlag", "[[lidar]]\nmodel = \"vlp16\"\n[gnss]\nuse = 1\n",
               "robot.toml:4: gnss.use = 1: must be true or false"},
        Broken{"GnssWithoutItsTerminal", "[[lidar]]\nmodel = \"vlp16\"\n[gnss]\nsource = \"serial\"\n",
               "robot.toml:4: gnss.source = \"serial\": needs gnss.device, the terminal, such as \"/dev/ttyACM0\""},
        Broken{"GnssAtAnOddRate", "[[lidar]]\nmodel = \"vlp16\"\n[gnss]\nbaud = 9601\n",
               "robot.toml:4: gnss.baud = 9601: must be a standard rate, such as 9600, 38400 or 115200, or 0"},
        Broken{"GnssOfALivox", "[[lidar]]\nmodel = \"livox_avia\"\n[gnss]\nsource = \"velodyne\"\n",
               "robot.toml:4: gnss.source = \"velodyne\": lidar.model sends no position packets"},
        Broken{"GnssOfPoints", "[[lidar]]\nmodel = \"points\"\n[gnss]\nsource = \"velodyne\"\n",
               "robot.toml:4: gnss.source = \"velodyne\": lidar.model sends no position packets"},
        Broken{"GnssAtTheTerminalOfTheImu",
               "[[lidar]]\nmodel = \"vlp16\"\n[imu]\nsource = \"serial\"\ndevice = \"/dev/a\"\n"
               "[gnss]\nsource = \"serial\"\ndevice = \"/dev/a\"\n",
               "robot.toml:8: gnss.device = \"/dev/a\": is the terminal of the inertial sensor"},
        Broken{"FractionOfAWholeNumber", "[[lidar]]\nmodel = \"vlp16\"\nport = 2368.5\n",
               "robot.toml:3: lidar.port = 2368.5: must be a whole number from 0 to 65535"},
        Broken{"NumberTooLarge", "[[lidar]]\nmodel = \"vlp16\"\nport = 65536\n",
               "robot.toml:3: lidar.port = 65536: must be a whole number from 0 to 65535"},
        Broken{"NumberTooSmall", "[[lidar]]\nmodel = \"vlp16\"\n[odometry]\nlittle_particles = 1\n",
               "robot.toml:4: odometry.little_particles = 1: must be a whole number from 2 to 256"},
        Broken{"WrongUnit", "[[lidar]]\nmodel = \"vlp16\"\nscan_period_ms = 0.1\n",
               "robot.toml:3: lidar.scan_period_ms = 0.1: must be a number from 20 to 500"},
        Broken{"NotANumber", "[[lidar]]\nmodel = \"vlp16\"\nmax_range_m = nan\n",
               "robot.toml:3: lidar.max_range_m = nan: must be a number from 1 to 1000"},
        Broken{"NoSuchChoice", "[[lidar]]\nmodel = \"vlp16\"\n[odometry]\nenvironment = \"underwater\"\n",
               "robot.toml:4: odometry.environment = 'underwater': must be one of \"auto\", \"indoor\", \"outdoor\""},
        Broken{"NoSuchModel", "[[lidar]]\nmodel = \"vlp64\"\n",
               "robot.toml:2: lidar.model = 'vlp64': must be one of \"vlp16\", \"vlp16_hires\", \"vlp32c\", \"hdl32e\", "
               "\"livox_avia\", \"livox_mid360\", \"points\""},
        Broken{"ModelOfALaterRelease", "[[lidar]]\nmodel = \"livox_horizon\"\n",
               "robot.toml:2: lidar.model = 'livox_horizon': not read by this release; must be one of \"vlp16\", "
               "\"vlp16_hires\", \"vlp32c\", \"hdl32e\", \"livox_avia\", \"livox_mid360\", \"points\""},
        Broken{"NoModel", "[[lidar]]\nport = 2368\n",
               "robot.toml: lidar.model: missing; must be one of \"vlp16\", \"vlp16_hires\", \"vlp32c\", \"hdl32e\", "
               "\"livox_avia\", \"livox_mid360\", \"points\" (the shortest configuration: [[lidar]] model = \"vlp16\")"},
        Broken{"TwoLidars", "[[lidar]]\nmodel = \"vlp16\"\n[[lidar]]\nmodel = \"hdl32e\"\n",
               "robot.toml:3: lidar: this release takes exactly one [[lidar]]"},
        Broken{"LidarInSingleBrackets", "[lidar]\nmodel = \"vlp16\"\n",
               "robot.toml:1: lidar: must be a table in double brackets: [[lidar]]"},
        Broken{"TransformOfTwoNumbers",
               "[[lidar]]\nmodel = \"vlp16\"\nT_base_lidar = { xyz_m = [0.1, 0.2], rpy_deg = [0, 0, 0] }\n",
               "robot.toml:3: lidar.T_base_lidar.xyz_m = [0.1, 0.2]: must be three numbers from -1000 to 1000"},
        Broken{"TransformWithAText",
               "[[lidar]]\nmodel = \"vlp16\"\nT_base_lidar = { xyz_m = [0.1, 0.2, \"up\"], rpy_deg = [0, 0, 0] }\n",
               "robot.toml:3: lidar.T_base_lidar.xyz_m = 'up': must be three numbers from -1000 to 1000"},
        Broken{"TransformInOtherUnits", "[[lidar]]\nmodel = \"vlp16\"\nT_base_lidar = { xyz_mm = [100, 0, 260] }\n",
               "robot.toml:3: lidar.T_base_lidar.xyz_mm = [100, 0, 260]: unknown key; did you mean "
               "lidar.T_base_lidar.xyz_m?"},
        Broken{"AngleBeyondATurn", "[[lidar]]\nmodel = \"vlp16\"\nT_base_lidar = { rpy_deg = [0, 0, 400] }\n",
               "robot.toml:3: lidar.T_base_lidar.rpy_deg = 400: must be three numbers from -360 to 360"},
        Broken{"BoxInsideOut",
               "[[lidar]]\nmodel = \"vlp16\"\n[self_filter]\nboxes = [{ min_m = [1, 0, 0], max_m = [0, 1, 1] }]\n",
               "robot.toml:4: self_filter.boxes = [{max_m = [0, 1, 1], min_m = [1, 0, 0]}]: must be up to 8 of "
               "{ min_m = [x, y, z], max_m = [x, y, z] }, each min below its max"},
        Broken{"BuiltInImuOfASensorThatHasNone", "[[lidar]]\nmodel = \"vlp16\"\n[imu]\nsource = \"livox\"\n",
               "robot.toml:4: imu.source = \"livox\": lidar.model has no built-in inertial sensor"},
        Broken{"BindAddressThatIsNone", "[[lidar]]\nmodel = \"vlp16\"\nbind_address = \"eth0\"\n",
               "robot.toml:3: lidar.bind_address = \"eth0\": must be an IPv4 address with dots, such as \"0.0.0.0\""},
        Broken{"SourceAddressThatIsNone", "[[lidar]]\nmodel = \"vlp16\"\nsource_address = \"192.168.1\"\n",
               "robot.toml:3: lidar.source_address = \"192.168.1\": must be an IPv4 address with dots, such as "
               "\"192.168.1.201\", or empty"},
        Broken{"RateThatNoSerialPortHas", "[[lidar]]\nmodel = \"vlp16\"\n[imu]\nbaud = 100000\n",
               "robot.toml:4: imu.baud = 100000: must be a standard rate, such as 115200, 230400, 460800 or 921600, or 0"},
        Broken{"SerialImuWithoutATerminal", "[[lidar]]\nmodel = \"vlp16\"\n[imu]\nsource = \"serial\"\n",
               "robot.toml:4: imu.source = \"serial\": needs imu.device, the terminal, such as \"/dev/ttyUSB0\""},
        Broken{"ProtocolThatNobodySpeaks", "[[lidar]]\nmodel = \"vlp16\"\n[imu]\nprotocol = \"can\"\n",
               "robot.toml:4: imu.protocol = 'can': must be one of \"csv\", \"xsens\", \"mip\", \"aceinna\""},
        Broken{"RateForASensorThatCannotBeTold", "[[lidar]]\nmodel = \"vlp16\"\n[imu]\nsource = \"serial\"\ndevice = \"/dev/ttyS1\"\nrate_hz = 400\n",
               "robot.toml:6: imu.rate_hz = 400: a sensor that sends CSV rows cannot be told; is for imu.protocol = \"xsens\" or \"mip\""},
        Broken{"XsensOverUdp", "[[lidar]]\nmodel = \"vlp16\"\n[imu]\nsource = \"udp\"\nprotocol = \"xsens\"\n",
               "robot.toml:5: imu.protocol = \"xsens\": is for imu.source = \"serial\"; \"udp\" takes \"csv\""},
        Broken{"ImuOnThePortOfTheLidar", "[[lidar]]\nmodel = \"vlp16\"\n[imu]\nsource = \"udp\"\nport = 2368\n",
               "robot.toml:5: imu.port = 2368: is a port of the LiDAR"},
        Broken{"ImuOnThePositionPort", "[[lidar]]\nmodel = \"vlp16\"\n[imu]\nsource = \"udp\"\nport = 8308\n",
               "robot.toml:5: imu.port = 8308: is a port of the LiDAR"}),
    [](const auto& broken) { return broken.param.name; });

TEST(Loader, RefusesWhatIsNoTomlWithItsLine) {
  for (const char* toml : {"[[lidar]]\nmodel = vlp16\n", "\nmodel = \"vlp16\n", "[odometry]\nseed = 1 2\n",
                           "[map]\n[map]\n", "[[lidar]]\nT_base_lidar = { xyz_m = [0, 0, 0\n"}) {
    const std::string refusal = refusal_of(toml);

    EXPECT_EQ(refusal.rfind("robot.toml:2: not TOML: ", 0), 0U) << refusal;
    EXPECT_EQ(refusal.find('\n'), std::string::npos);
  }
}

TEST(Loader, KeepsARefusalOnOneLineWhenTheValueHasSeveral) {
  const std::string refusal = refusal_of("[[lidar]]\nmodel = \"\"\"vlp\n16\r\n\"\"\"\n\"o\\nther\" = 1\n");

  EXPECT_NE(refusal, "");
  EXPECT_EQ(refusal.find_first_of("\r\n"), std::string::npos);
}

struct BrokenOverride {
  const char* name;
  const char* key_value;
  const char* refusal;
};

void PrintTo(const BrokenOverride& broken, std::ostream* stream) { *stream << broken.name; }

class OverrideTest : public testing::TestWithParam<BrokenOverride> {};

TEST_P(OverrideTest, IsRefusedInOneLineWithKeyValueAndWhatIsAllowed) {
  EXPECT_EQ(refusal_of("[[lidar]]\nmodel = \"vlp16\"\n", {GetParam().key_value}), GetParam().refusal);
}

INSTANTIATE_TEST_SUITE_P(
    All,
    OverrideTest,
    testing::Values(
        BrokenOverride{"UnknownKey", "odometry.sed=3", "--set odometry.sed=3: unknown key; did you mean odometry.seed?"},
        BrokenOverride{"KeyLikeNoOther", "camera=3", "--set camera=3: unknown key; docs/configuration.md lists them"},
        BrokenOverride{"NoValue", "odometry.seed", "--set odometry.seed: must be key=value"},
        BrokenOverride{"NoKey", "=3", "--set =3: must be key=value"},
        BrokenOverride{"EmptyNumber", "odometry.seed=", "--set odometry.seed=: must be a whole number from 0 to 1000000000"},
        BrokenOverride{"TextForANumber", "odometry.seed=one", "--set odometry.seed=one: must be a whole number from 0 to 1000000000"},
        BrokenOverride{"OutOfRange", "lidar.max_range_m=0.5",
                       "--set lidar.max_range_m = 0.5: must be a number from 1 to 1000"},
        BrokenOverride{"NoSuchChoice", "odometry.filter=kalman",
                       "--set odometry.filter = 'kalman': must be one of \"psf\", \"iekf\""},
        BrokenOverride{"SecondLine", "odometry.seed=3\nlidar=4",
                       "--set odometry.seed=3 lidar=4: must be a whole number from 0 to 1000000000"},
        BrokenOverride{"WholeTransform", "lidar.T_base_lidar=[0,0,0]",
                       "--set lidar.T_base_lidar=[0,0,0]: must be a table of xyz_m, rpy_deg"}),
    [](const auto& broken) { return broken.param.name; });

using LoaderFile = scratch::ScratchFolder;

TEST_F(LoaderFile, RefusesAFileThatIsNotThere) {
  Loader sut;

  EXPECT_EQ(message_of<ConfigurationError>([&] { sut.add_file(folder_ / "no.toml"); }),
            (folder_ / "no.toml").string() + ": cannot be read");
}

TEST_F(LoaderFile, RefusesAFolderInAFilesPlace) {
  Loader sut;

  EXPECT_EQ(message_of<ConfigurationError>([&] { sut.add_file(folder_); }), folder_.string() + ": cannot be read");
}

TEST_F(LoaderFile, NamesTheFileThatHoldsTheBadValueAmongSeveral) {
  Loader sut;
  sut.add_file(write("good.toml", "[[lidar]]\nmodel = \"vlp16\"\n"));
  const auto bad = write("bad.toml", "\n\n[odometry]\nseed = -1\n");

  EXPECT_EQ(message_of<ConfigurationError>([&] { sut.add_file(bad); }),
            bad.string() + ":4: odometry.seed = -1: must be a whole number from 0 to 1000000000");
}

TEST_F(LoaderFile, NamesAllFilesWhenNoneHasAModel) {
  Loader sut;
  sut.add_file(write("a.toml", ""));
  sut.add_file(write("b.toml", "[odometry]\nseed = 1\n"));

  const std::string refusal = message_of<ConfigurationError>([&] { sut.load(); });

  EXPECT_EQ(refusal.rfind((folder_ / "a.toml").string() + ", " + (folder_ / "b.toml").string() + ": lidar.model: missing", 0), 0U)
      << refusal;
}

}  // namespace
}  // namespace slamd::configuration
