#include "drivers/storage/session_keeper.hpp"

#include <gtest/gtest.h>

#include "drivers/storage/session_reader.hpp"
#include "tests/circles/circles.hpp"
#include "tests/drivers/storage/full_disk.hpp"
#include "tests/scratch/scratch_folder.hpp"

namespace slamd::storage {
namespace {

namespace fs = std::filesystem;

/// The time at which the map's sessions are made.
Stamp at(int seconds) { return Stamp(std::chrono::seconds(1'800'000'000 + seconds)); }

class SessionKeeperTest : public scratch::ScratchFolder {
 protected:
  SessionKeeping keeping() const { return {.folder = folder_ / "sessions", .sensor = "vlp16", .software = "test"}; }

  void drive(SessionKeeper& sut, int scans, Stamp now) {
    for (int i = 0; i < scans; ++i) {
      sut.note(mapper_, mapper_.process(drive_.step()), now);
    }
  }

  std::vector<std::string> sessions() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_ / "sessions")) {
      names.push_back(entry.path().filename());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  std::uint64_t bytes_of_all() const {
    std::uint64_t bytes = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / "sessions")) {
      bytes += entry.is_regular_file() ? entry.file_size() : 0;
    }
    return bytes;
  }

  /// Makes a session of another day, last written so many hours ago.
  void make_other(const std::string& name, std::uint64_t bytes, int hours_ago) const {
    const fs::path file = write(fs::path("sessions") / name / segment_name(0), "");
    fs::resize_file(file, bytes);
    fs::last_write_time(file, fs::file_time_type::clock::now() - std::chrono::hours(hours_ago));
  }

  void expect_is_the_map(const fs::path& session) const {
    const Session read = read_session(session);
    ASSERT_EQ(read.keyframes.size(), mapper_.keyframes().size());
    for (std::size_t i = 0; i < read.keyframes.size(); ++i) {
      EXPECT_EQ(read.keyframes[i].id, mapper_.keyframes()[i].id);
      EXPECT_LT(boxminus(read.T_map_base[i], mapper_.T_map_base(i)).norm(), 1.2e-3);
    }
    EXPECT_EQ(read.loops.size(), mapper_.graph().loops());
  }

  circles::Circles drive_;
  mapping::Mapper mapper_{circles::small()};
};

TEST_F(SessionKeeperTest, BeginsASessionWithTheFirstKeyframeAndKeepsItUpWithTheMap) {
  SessionKeeper sut(keeping());
  sut.attend(mapper_, at(0));
  EXPECT_FALSE(fs::exists(folder_ / "sessions")) << "nothing to keep yet";

  drive(sut, 200, at(1));

  EXPECT_EQ(sessions(), std::vector<std::string>{session_name(at(1))});
  EXPECT_GT(mapper_.counts().accepted(), 0U);
  expect_is_the_map(sut.session());  // as it is when the process is killed now
}

TEST_F(SessionKeeperTest, BeginsAnotherForAnotherMapAndTakesTheOldestAway) {
  SessionKeeping keeping_two = keeping();
  keeping_two.sessions = 2;
  SessionKeeper sut(keeping_two);
  fs::create_directories(folder_ / "sessions" / "20000101T000000Z");  // an old one
  fs::create_directories(folder_ / "sessions" / "holidays");          // none of ours

  for (int map = 0; map < 3; ++map) {
    drive(sut, 20, at(map));
    sut.close();
    mapper_.restart();
  }

  EXPECT_EQ(sessions(), (std::vector<std::string>{session_name(at(1)), session_name(at(2)), "holidays"}));
  EXPECT_EQ(sut.removed(), 2U);
  EXPECT_TRUE(read_session(folder_ / "sessions" / session_name(at(2))).closed);
}

TEST_F(SessionKeeperTest, KeepsAllSessionsWithinTheQuota) {
  SessionKeeping little = keeping();
  {
    SessionKeeper before(keeping());
    drive(before, 40, at(0));
    little.quota_bytes = before.bytes() * 6 / 5;
    little.least_segment_bytes = 1'000;
    before.close();
    mapper_.restart();
  }
  SessionKeeper sut(little);

  for (int second = 1; second < 8; ++second) {
    drive(sut, 10, at(second));
  }

  EXPECT_EQ(sessions(), std::vector<std::string>{session_name(at(1))});
  EXPECT_LE(bytes_of_all(), little.quota_bytes);
  EXPECT_GT(bytes_of_all(), little.quota_bytes / 2);
  EXPECT_EQ(bytes_of_all(), sut.bytes());
  EXPECT_EQ(read_session(sut.session()).keyframes.back().id, mapper_.keyframes()[mapper_.keyframes().size() - 1].id);
}

TEST_F(SessionKeeperTest, WritesFilesThatAreSmallByTheQuota) {
  SessionKeeping some = keeping();
  EXPECT_EQ(limits_of(some).segment_bytes, 64U << 20U);
  some.quota_bytes = 2'000'000'000;
  EXPECT_EQ(limits_of(some).segment_bytes, 64U << 20U);
  some.quota_bytes = 10'000'000;
  EXPECT_EQ(limits_of(some).segment_bytes, 1'250'000U);
  EXPECT_EQ(limits_of(some).quota_bytes, 10'000'000U);
  some.quota_bytes = 1;
  EXPECT_EQ(limits_of(some).segment_bytes, 1'000'000U);
}

TEST_F(SessionKeeperTest, TakesStartsThatSoonEndedAwayBeforeAnyMap) {
  SessionKeeping keeping_three = keeping();
  keeping_three.sessions = 3;
  make_other("20260101T000000Z", 5'000'000, 9);
  make_other("20260102T000000Z", 5'000'000, 8);
  for (int restart = 0; restart < 10; ++restart) {
    SessionKeeper sut(keeping_three);
    drive(sut, 8, at(restart));
    EXPECT_GT(sut.bytes(), 0U);
    mapper_.restart();
  }

  EXPECT_EQ(sessions(), (std::vector<std::string>{"20260101T000000Z", "20260102T000000Z", session_name(at(9))}));
}

TEST_F(SessionKeeperTest, TakesTheMapAwayThatWasWrittenLongestAgoWhateverItsName) {
  SessionKeeping keeping_three = keeping();
  keeping_three.sessions = 3;
  make_other("20260101T000000Z", 1'000'000, 1);  // begun while the clock was not set
  make_other("20260303T000000Z-2", 1'000'000, 5);
  make_other("20260303T000000Z-10", 1'000'000, 4);
  SessionKeeper sut(keeping_three);

  drive(sut, 20, at(0));

  EXPECT_EQ(sut.removed(), 1U);
  EXPECT_EQ(sessions(), (std::vector<std::string>{"20260101T000000Z", "20260303T000000Z-10", session_name(at(0))}));
}

TEST_F(SessionKeeperTest, WritesWhatAFullDiskHasDropped) {
  SessionKeeper sut(keeping());
  drive(sut, 30, at(0));
  {
    const FullDisk full(sut.bytes() + 100);
    drive(sut, 100, at(1));
    EXPECT_NE(sut.fault().find("cannot be written: File too large"), std::string::npos) << sut.fault();
  }
  drive(sut, 1, at(5));
  EXPECT_FALSE(sut.fault().empty()) << "it is not asked all the time";

  sut.attend(mapper_, at(12));

  EXPECT_EQ(sut.fault(), "");
  expect_is_the_map(sut.session());
}

TEST_F(SessionKeeperTest, BeginsLateWhereTheFolderCannotBeMadeAtFirst) {
  write("sessions", "a file in the folder's place");
  SessionKeeper sut(keeping());
  drive(sut, 60, at(0));
  EXPECT_NE(sut.fault().find("sessions"), std::string::npos) << sut.fault();
  fs::remove(folder_ / "sessions");

  sut.attend(mapper_, at(11));

  EXPECT_EQ(sut.fault(), "");
  expect_is_the_map(sut.session());
}

TEST_F(SessionKeeperTest, KnowsASessionByItsName) {
  EXPECT_EQ(session_name(at(0)), "20270115T080000Z");
  for (const char* name : {"20270115T080000Z", "20270115T080000Z-2"}) {
    EXPECT_TRUE(is_session_name(name)) << name;
  }
  for (const char* name : {"", "holidays", "20270115T080000", "20270115T080000Z-", "20270115T080000Z-x", "20270115T0800x0Z", "20270115T080000Z2"}) {
    EXPECT_FALSE(is_session_name(name)) << name;
  }
}

}  // namespace
}  // namespace slamd::storage
