#include "drivers/storage/session_reader.hpp"
#include "drivers/storage/session_writer.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <numeric>
#include <random>

#include "core/base/bytes.hpp"
#include "tests/drivers/storage/full_disk.hpp"
#include "tests/scratch/scratch_folder.hpp"

namespace slamd::storage {
namespace {

namespace fs = std::filesystem;
using geometry::Se3;

const SessionBegin kBegin{.session = 77, .segment = 0, .sensor = "vlp16", .software = "slamd 0.1.0"};

Se3 made_pose(double seed) {
  return {Eigen::Quaterniond(1.0, 0.1 * seed, -0.2, 0.05).normalized(), Eigen::Vector3d(seed, -2.0 * seed, 0.25)};
}

SessionKeyframe made_keyframe(graph::KeyframeId id, std::size_t points = 20) {
  SessionKeyframe keyframe;
  keyframe.id = id;
  keyframe.submap = id / 4;
  keyframe.stamp = Stamp(Duration(1'700'000'000'000'000'000 + 100'000'000LL * id));
  keyframe.T_odom_base = made_pose(id);
  keyframe.R_base_level = made_pose(0.1 * id).rotation();
  keyframe.path_m = 1.5 * id;
  keyframe.median_range_m = 8.25;
  keyframe.odometry.T_a_b = made_pose(1.0);
  keyframe.odometry.information = 1e4 * geometry::Matrix6d::Identity();
  keyframe.odometry.information(0, 5) = keyframe.odometry.information(5, 0) = 12.5;
  if (id % 2 == 0) {
    keyframe.gravity = graph::GravityFactor{Eigen::Vector3d(0.0, 0.6, 0.8), 0.02};
  }
  for (std::size_t i = 0; i < points; ++i) {
    keyframe.cloud_level.emplace_back(0.005F * static_cast<float>(i), -0.5F, 1.0F + static_cast<float>(id));
  }
  return keyframe;
}

SessionLoop made_loop(graph::LoopId id, graph::KeyframeId a, graph::KeyframeId b, bool accepted) {
  return {id, a, b, {made_pose(0.5), 400.0 * geometry::Matrix6d::Identity()}, accepted};
}

std::vector<graph::KeyframeId> ids_of(const Session& session) {
  std::vector<graph::KeyframeId> ids;
  for (const SessionKeyframe& keyframe : session.keyframes) {
    ids.push_back(keyframe.id);
  }
  return ids;
}

class SessionTest : public scratch::ScratchFolder {
 protected:
  /// Three keyframes, a loop, poses: one file.
  fs::path write_small() {
    SessionWriter writer(folder_, kBegin, {});
    for (graph::KeyframeId id = 0; id < 3; ++id) {
      writer.write(made_keyframe(id, 3));
    }
    writer.write(made_loop(5, 0, 2, true));
    const std::vector<SessionPose> poses{{0, made_pose(7.0)}, {2, made_pose(9.0)}};
    writer.write(poses);
    writer.close();
    return folder_ / segment_name(0);
  }
};

TEST_F(SessionTest, GivesBackWhatWasWritten) {
  write_small();

  const Session sut = read_session(folder_);

  EXPECT_EQ(sut.begin, kBegin);
  EXPECT_TRUE(sut.closed);
  EXPECT_TRUE(sut.damage.empty());
  EXPECT_EQ(sut.lost_records, 0U);
  ASSERT_EQ(ids_of(sut), (std::vector<graph::KeyframeId>{0, 1, 2}));
  const SessionKeyframe& keyframe = sut.keyframes[2];
  const SessionKeyframe expected = made_keyframe(2, 3);
  EXPECT_EQ(keyframe.submap, expected.submap);
  EXPECT_EQ(keyframe.stamp, expected.stamp);
  EXPECT_LT(boxminus(keyframe.T_odom_base, expected.T_odom_base).norm(), 1e-12);
  EXPECT_LT((keyframe.R_base_level - expected.R_base_level).norm(), 1e-12);
  EXPECT_EQ(keyframe.path_m, expected.path_m);
  EXPECT_EQ(keyframe.median_range_m, expected.median_range_m);
  EXPECT_EQ(keyframe.odometry.information, expected.odometry.information);
  ASSERT_TRUE(keyframe.gravity.has_value());
  EXPECT_EQ(keyframe.gravity->up_base, expected.gravity->up_base);
  EXPECT_FALSE(sut.keyframes[1].gravity.has_value());
  ASSERT_EQ(keyframe.cloud_level.size(), 3U);
  EXPECT_LT((keyframe.cloud_level[2] - expected.cloud_level[2]).norm(), 0.0026F);
  ASSERT_EQ(sut.loops.size(), 1U);
  EXPECT_EQ(sut.loops[0].id, 5U);
  EXPECT_TRUE(sut.loops[0].accepted);
  EXPECT_EQ(sut.loops[0].a, 0U);
  EXPECT_EQ(sut.loops[0].b, 2U);
  EXPECT_LT(boxminus(sut.loops[0].factor.T_a_b, made_pose(0.5)).norm(), 1e-12);
  EXPECT_LT(boxminus(keyframe.odometry.T_a_b, expected.odometry.T_a_b).norm(), 1e-12);
  EXPECT_EQ(keyframe.gravity->std_rad, 0.02);
  EXPECT_LT(boxminus(sut.T_map_base[0], made_pose(7.0)).norm(), 1e-12);
  EXPECT_LT(boxminus(sut.T_map_base[1], made_pose(1.0)).norm(), 1e-12) << "no correction: as in odom";
}

TEST_F(SessionTest, BelievesTheLastWord) {
  {
    SessionWriter writer(folder_, kBegin, {});
    for (graph::KeyframeId id = 0; id < 4; ++id) {
      writer.write(made_keyframe(id));
    }
    writer.write(made_loop(1, 0, 3, true));
    writer.write(made_loop(2, 1, 2, true));
    writer.write(made_loop(1, 0, 3, false));
    writer.retire(2);
  }

  const Session sut = read_session(folder_);

  EXPECT_FALSE(sut.closed);
  EXPECT_EQ(ids_of(sut), (std::vector<graph::KeyframeId>{0, 1, 3}));
  ASSERT_EQ(sut.loops.size(), 1U) << "the other hangs on a keyframe that is gone";
  EXPECT_FALSE(sut.loops[0].accepted);
}

TEST_F(SessionTest, OpensWhereverItIsCutOffWithAllThatWasWhole) {
  const fs::path file = write_small();
  const std::string whole = text_of(file);
  const auto bytes = std::as_bytes(std::span(whole));
  std::vector<std::size_t> ends;
  for (std::size_t at = 0; at < whole.size();) {
    RecordFrame frame;
    ASSERT_EQ(read_frame(bytes.subspan(at), frame), FrameVerdict::kGood);
    at += frame.bytes();
    ends.push_back(at);
  }
  ASSERT_EQ(ends.size(), 7U);

  for (std::size_t size = 0; size < whole.size(); ++size) {
    write(segment_name(0), whole.substr(0, size));
    const auto records = static_cast<std::size_t>(std::upper_bound(ends.begin(), ends.end(), size) - ends.begin());
    if (records == 0) {
      EXPECT_THROW(read_session(folder_), std::runtime_error) << size;
      continue;
    }
    const Session sut = read_session(folder_);
    ASSERT_EQ(sut.records, records) << size;
    ASSERT_EQ(sut.keyframes.size(), std::min<std::size_t>(3, records - 1)) << size;
    ASSERT_EQ(sut.damage.size(), ends[records - 1] == size ? 0U : 1U) << size;
    if (!sut.damage.empty()) {
      ASSERT_EQ(sut.damage[0].offset, ends[records - 1]);
      ASSERT_EQ(sut.damage[0].bytes, size - ends[records - 1]);
    }
  }
}

TEST_F(SessionTest, NamesEachFlippedBitAndKeepsTheOtherRecords) {
  const fs::path file = write_small();
  const std::string whole = text_of(file);
  RecordFrame begin;
  ASSERT_EQ(read_frame(std::as_bytes(std::span(whole)), begin), FrameVerdict::kGood);
  std::mt19937 random(3);

  for (std::size_t at = begin.bytes(); at < whole.size(); ++at) {
    std::string flipped = whole;
    flipped[at] = static_cast<char>(flipped[at] ^ (1 << random() % 8));
    write(segment_name(0), flipped);

    const Session sut = read_session(folder_);

    ASSERT_EQ(sut.damage.size(), 1U) << at;
    ASSERT_EQ(sut.damage[0].segment, "000000.slamd");
    ASSERT_EQ(sut.records, 6U) << at;
    ASSERT_EQ(sut.lost_records, sut.closed ? 1U : 0U) << at << ": of the last one nobody knows";
  }
}

TEST_F(SessionTest, SurvivesAnythingInItsFiles) {
  const fs::path file = write_small();
  const std::string whole = text_of(file);
  std::mt19937 random(4);
  for (int i = 0; i < 100; ++i) {
    std::string bytes = whole;
    for (int k = 0; k < 1 + i; ++k) {
      bytes[random() % bytes.size()] = static_cast<char>(random());
    }
    bytes.insert(random() % bytes.size(), std::string("SLMK") + std::string(random() % 40, '\x01'));
    write(segment_name(0), bytes);
    try {
      const Session sut = read_session(folder_);
      EXPECT_FALSE(sut.damage.empty());
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find("not one record"), std::string::npos) << error.what();
    }
  }
}

TEST_F(SessionTest, GivesUpOnAFileThatOnlyLooksLikeRecords) {
  const std::string whole = text_of(write_small());
  std::string hostile = whole;
  std::string claim(16, '\0');
  std::span<std::byte> head = std::as_writable_bytes(std::span(claim));
  store_le(head, 0, RecordFrame::kMagic);
  store_le(head, 4, std::uint32_t{1U << 20U});
  for (int i = 0; i < 200'000; ++i) {
    hostile += claim;
  }
  write(segment_name(0), hostile);

  const Session sut = read_session(folder_);  // would check 200 GB otherwise

  EXPECT_EQ(sut.keyframes.size(), 3U);
  ASSERT_EQ(sut.damage.size(), 1U);
  EXPECT_EQ(sut.damage[0].offset, whole.size());
}

TEST_F(SessionTest, RefusesRecordsWhoseNumbersAreNone) {
  SessionKeyframe keyframe = made_keyframe(1);
  keyframe.path_m = std::numeric_limits<double>::quiet_NaN();
  {
    SessionWriter writer(folder_, kBegin, {});
    writer.write(keyframe);
    writer.write(made_keyframe(2));
  }

  const Session sut = read_session(folder_);

  EXPECT_EQ(ids_of(sut), (std::vector<graph::KeyframeId>{2}));
  ASSERT_EQ(sut.damage.size(), 1U);
  EXPECT_EQ(sut.damage[0].what, "holds a number that is none");
}

TEST_F(SessionTest, GoesFromFileToFileAndLetsTheOldestGoAtTheQuota) {
  constexpr graph::KeyframeId kCount = 200;
  {
    SessionWriter writer(folder_, kBegin, {.segment_bytes = 20'000, .quota_bytes = 100'000});
    for (graph::KeyframeId id = 0; id < kCount; ++id) {
      writer.write(made_keyframe(id, 200));
      EXPECT_LE(writer.bytes(), 100'000U);
    }
    EXPECT_GT(writer.dropped_segments(), 5U);
    EXPECT_EQ(writer.dropped_records(), 0U);
    writer.close();
  }

  const Session sut = read_session(folder_);

  EXPECT_LE(sut.bytes, 100'000U);
  EXPECT_TRUE(sut.closed);
  EXPECT_TRUE(sut.damage.empty());
  EXPECT_EQ(sut.keyframes.back().id, kCount - 1);
  EXPECT_GT(sut.keyframes.front().id, 100U);
  EXPECT_EQ(sut.keyframes.size(), kCount - sut.keyframes.front().id);
  EXPECT_GT(sut.lost_records, 100U);
}

TEST_F(SessionTest, TakesTheFilesOfAnEarlierSessionAway) {
  write("000007.slamd", "old");
  write("notes.txt", "mine");
  write_small();

  EXPECT_FALSE(fs::exists(folder_ / "000007.slamd"));
  EXPECT_TRUE(fs::exists(folder_ / "notes.txt"));
  EXPECT_EQ(read_session(folder_).segments, 1U);
}

TEST_F(SessionTest, LosesNothingThatWasWrittenWhenItIsKilled) {
  std::mt19937 random(5);
  for (int i = 0; i < 25; ++i) {
    int reports[2];
    ASSERT_EQ(pipe(reports), 0);
    const pid_t writing = fork();
    if (writing == 0) {
      SessionWriter writer(folder_ / "killed", kBegin, {.segment_bytes = 50'000, .quota_bytes = 0});
      for (graph::KeyframeId id = 0;; ++id) {
        writer.write(made_keyframe(id, 500));
        if (::write(reports[1], &id, sizeof id) != sizeof id) {
          _exit(1);
        }
      }
    }
    ::close(reports[1]);
    graph::KeyframeId last = 0;
    const graph::KeyframeId enough = random() % 60;
    while (last < enough && ::read(reports[0], &last, sizeof last) == sizeof last) {
    }
    kill(writing, SIGKILL);
    waitpid(writing, nullptr, 0);
    while (::read(reports[0], &last, sizeof last) == sizeof last) {
    }
    ::close(reports[0]);

    const Session sut = read_session(folder_ / "killed");

    ASSERT_GE(sut.keyframes.size(), last + 1U);
    std::vector<graph::KeyframeId> all(sut.keyframes.size());
    std::iota(all.begin(), all.end(), 0U);
    ASSERT_EQ(ids_of(sut), all);
  }
}

TEST_F(SessionTest, SaysThatTheDiskIsFullAndGoesOnWhenItIsNot) {
  SessionWriter writer(folder_, kBegin, {});
  writer.write(made_keyframe(0, 100));
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  signal(SIGXFSZ, SIG_IGN);
  rlimit small = before;
  small.rlim_cur = writer.bytes() + 100;
  setrlimit(RLIMIT_FSIZE, &small);

  writer.write(made_keyframe(1, 100));
  const std::string fault = writer.fault();
  writer.write(made_keyframe(2, 100));
  setrlimit(RLIMIT_FSIZE, &before);

  EXPECT_NE(fault.find("000000.slamd: cannot be written: File too large"), std::string::npos) << fault;
  EXPECT_EQ(writer.dropped_records(), 2U);
  EXPECT_TRUE(writer.retry());
  writer.write(made_keyframe(3, 100));
  writer.close();
  const Session sut = read_session(folder_);
  EXPECT_TRUE(sut.damage.empty()) << "cut back to the last whole record";
  EXPECT_EQ(ids_of(sut), (std::vector<graph::KeyframeId>{0, 3}));
  EXPECT_EQ(sut.lost_records, 2U);
}

TEST_F(SessionTest, LeavesNoFilesBehindWhileTheDiskStaysFull) {
  SessionWriter writer(folder_, kBegin, {});
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  signal(SIGXFSZ, SIG_IGN);
  rlimit small = before;
  small.rlim_cur = 10;
  setrlimit(RLIMIT_FSIZE, &small);
  writer.write(made_keyframe(0));
  for (int i = 0; i < 10; ++i) {
    EXPECT_FALSE(writer.retry());
  }
  setrlimit(RLIMIT_FSIZE, &before);

  EXPECT_TRUE(fs::is_empty(folder_));
  EXPECT_TRUE(writer.retry());
  writer.write(made_keyframe(1));
  writer.close();
  const Session sut = read_session(folder_);
  EXPECT_EQ(ids_of(sut), (std::vector<graph::KeyframeId>{1}));
  EXPECT_EQ(sut.lost_records, 1U);
}

TEST_F(SessionTest, LeavesOneFileBehindWhereTheDiskHasRoomForItsBeginAlone) {
  SessionWriter writer(folder_, kBegin, {});
  writer.write(made_keyframe(0, 100));
  const std::uint64_t bytes = writer.bytes();
  {
    const FullDisk full(300);
    for (int i = 0; i < 10; ++i) {
      writer.write(made_keyframe(1, 100));
      EXPECT_TRUE(writer.retry());
    }
  }

  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 2);
  EXPECT_LT(writer.bytes(), bytes + 300);
  writer.write(made_keyframe(2, 100));
  writer.close();
  const Session sut = read_session(folder_);
  EXPECT_EQ(ids_of(sut), (std::vector<graph::KeyframeId>{0, 2}));
  EXPECT_EQ(sut.segments, 2U);
  EXPECT_TRUE(sut.damage.empty());
  EXPECT_EQ(sut.lost_records, 10U);
}

TEST_F(SessionTest, GivesARecordThatIsLargerThanAFileOneToItself) {
  {
    SessionWriter writer(folder_, kBegin, {.segment_bytes = 1'000});
    for (graph::KeyframeId id = 0; id < 3; ++id) {
      writer.write(made_keyframe(id, 500));
    }
  }

  const Session sut = read_session(folder_);

  EXPECT_EQ(ids_of(sut), (std::vector<graph::KeyframeId>{0, 1, 2}));
  EXPECT_EQ(sut.segments, 3U);
}

TEST_F(SessionTest, TakesNothingOfAnotherSessionsFiles) {
  {
    SessionBegin other = kBegin;
    other.session = 78;
    SessionWriter writer(folder_ / "other", other, {});
    writer.write(made_keyframe(9));
  }
  write_small();
  fs::copy_file(folder_ / "other" / segment_name(0), folder_ / segment_name(1));

  const Session sut = read_session(folder_);

  EXPECT_EQ(ids_of(sut), (std::vector<graph::KeyframeId>{0, 1, 2}));
  ASSERT_EQ(sut.damage.size(), 2U);
  EXPECT_EQ(sut.damage[1].what, "belongs to another session");
}

TEST_F(SessionTest, RefusesWhatNoMapCanHold) {
  SessionKeyframe far = made_keyframe(1);
  far.T_odom_base.translation().x() = 1e300;
  SessionKeyframe leaning = made_keyframe(2);
  leaning.gravity->std_rad = 0.0;
  {
    SessionWriter writer(folder_, kBegin, {});
    writer.write(far);
    writer.write(leaning);
    writer.write(made_loop(1, 2, 1, true));
  }

  const Session sut = read_session(folder_);

  EXPECT_TRUE(sut.keyframes.empty());
  ASSERT_EQ(sut.damage.size(), 3U);
  EXPECT_EQ(sut.damage[0].what, "lies beyond all bounds");
  EXPECT_EQ(sut.damage[1].what, "holds a vertical that is none");
  EXPECT_EQ(sut.damage[2].what, "joins no earlier keyframe with a later one");
}

TEST_F(SessionTest, SaysWhereThereIsNone) {
  EXPECT_NE(scratch::message_of<std::runtime_error>([&] { read_session(folder_); }).find("holds no session (no file such as 000000.slamd)"), std::string::npos);
  EXPECT_NE(scratch::message_of<std::runtime_error>([&] { read_session(folder_ / "no"); }).find("No such file"), std::string::npos);
}

}  // namespace
}  // namespace slamd::storage
