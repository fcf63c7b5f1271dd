#include "drivers/recording/candump.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "drivers/recording/packet.hpp"
#include "tests/scratch/scratch_folder.hpp"

namespace slamd::recording {
namespace {

using transport::CanFrame;

CanLine parsed(std::string_view line) {
  CanFrame frame;
  std::string_view interface;
  return parse_candump(line, frame, interface);
}

TEST(Candump, ReadsWhatCandumpWrites) {
  CanFrame frame;
  std::string_view interface;

  ASSERT_EQ(parse_candump("(1436509052.249713) vcan0 044#2A366C2BBA", frame, interface), CanLine::kFrame);

  EXPECT_EQ(interface, "vcan0");
  EXPECT_EQ(frame.id, 0x44U);
  EXPECT_FALSE(frame.is_extended);
  EXPECT_EQ(frame.size, 5U);
  EXPECT_EQ(frame.data[0], std::byte{0x2A});
  EXPECT_EQ(frame.data[4], std::byte{0xBA});
  EXPECT_EQ(frame.received, Stamp{} + std::chrono::microseconds{1'436'509'052'249'713});
}

TEST(Candump, ReadsLongIdsDirectionsAndFramesWithoutData) {
  CanFrame frame;
  std::string_view interface;

  ASSERT_EQ(parse_candump("(1.000000001) can1 08F02D80#0C7DDE7C2B790002 T\r", frame, interface), CanLine::kFrame);
  EXPECT_TRUE(frame.is_extended);
  EXPECT_EQ(frame.id, 0x08F02D80U);
  EXPECT_EQ(frame.size, 8U);
  EXPECT_EQ(frame.received, Stamp{} + std::chrono::nanoseconds{1'000'000'001});
  ASSERT_EQ(parse_candump("(1.0) can1 00000001# R", frame, interface), CanLine::kFrame);
  EXPECT_TRUE(frame.is_extended);
  EXPECT_EQ(frame.size, 0U);
}

TEST(Candump, TellsWhatCarriesNoDataFromWhatIsBroken) {
  for (const char* line : {"(1.0) can0 123#R", "(1.0) can0 123#R8", "(1.0) can0 20000040#0000000000000000", "(1.0) can0 123##1AABB"}) {
    EXPECT_EQ(parsed(line), CanLine::kOther) << line;
  }
  for (const char* line : {"", "(", "(1.0", "(1.0)", "(1.0) ", "(1.0) can0", "(1.0) can0 ", "(1.0) can0 123", "1.0 can0 123#00", "(x) can0 123#00",
                           "(1.0)can0 123#00", "(1.0)  123#00", "(1.0) can0 12#00", "(1.0) can0 FFF#00", "(1.0) can0 12G#00",
                           "(1.0) can0 123#0", "(1.0) can0 123#0G", "(1.0) can0 123#001122334455667788", "(1.0) can0 FFFFFFFF1#00",
                           "(1.0) can0 40000000#00", "(1.0) a_name_too_long_ 123#00", "(1.0) ca\tn0 123#00", "(1.0) can0 -12#00"}) {
    EXPECT_EQ(parsed(line), CanLine::kMalformed) << line;
  }
}

TEST(Candump, ReadsBackWhatItWrites) {
  CanFrame frame{.id = 0x1A0, .is_extended = false, .size = 3, .data = {std::byte{1}, std::byte{0xFF}, std::byte{0x30}},
                 .received = Stamp{} + std::chrono::microseconds{1'700'000'000'000'042}};
  CanFrame again;
  std::string_view interface;

  EXPECT_EQ(candump_line("can0", frame), "(1700000000.000042) can0 1A0#01FF30\n");
  frame.is_extended = true;
  EXPECT_EQ(candump_line("can0", frame), "(1700000000.000042) can0 000001A0#01FF30\n");
  std::string line = candump_line("can0", frame);
  line.pop_back();
  ASSERT_EQ(parse_candump(line, again, interface), CanLine::kFrame);
  EXPECT_EQ(again.received, frame.received);
  EXPECT_EQ(again.data, frame.data);
}

class CandumpFile : public scratch::ScratchFolder {};

TEST_F(CandumpFile, IsReadForOneInterfaceOrAll) {
  std::filesystem::create_directories(folder_);
  std::ofstream(folder_ / "can.log") << "(1.0) can0 001#00\n(2.0) can1 002#00\nnonsense\n\n(3.0) can0 003#R\n(4.0) can0 004#00\n";
  CandumpReader one(folder_ / "can.log", "can0");
  CandumpReader all(folder_ / "can.log");
  CanFrame frame;
  std::vector<std::uint32_t> ids;

  while (one.next(frame)) {
    ids.push_back(frame.id);
  }
  while (all.next(frame)) {
  }

  EXPECT_EQ(ids, (std::vector<std::uint32_t>{1, 4}));
  EXPECT_EQ(one.counters().foreign, 1U);
  EXPECT_EQ(one.counters().other, 1U);
  EXPECT_EQ(one.counters().malformed, 1U);
  EXPECT_EQ(all.counters().frames, 3U);
  EXPECT_THROW(CandumpReader(folder_ / "none.log"), RecordingError);
}

}  // namespace
}  // namespace slamd::recording
