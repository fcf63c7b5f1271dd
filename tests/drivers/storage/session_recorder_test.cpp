#include "drivers/storage/session_recorder.hpp"

#include <gtest/gtest.h>

#include "drivers/storage/session_reader.hpp"
#include "tests/circles/circles.hpp"
#include "tests/scratch/scratch_folder.hpp"

namespace slamd::storage {
namespace {

class SessionRecorderTest : public scratch::ScratchFolder {
 protected:
  /// Drives in circles, and keeps the session.
  void drive(mapping::Mapper& mapper, int scans) {
    circles::Circles drive;
    SessionRecorder sut(folder_, {.session = 1, .segment = 0, .sensor = "vlp16", .software = "test"}, {});
    for (int i = 0; i < scans; ++i) {
      sut.note(mapper, mapper.process(drive.step()));
    }
    sut.note(mapper, mapper.finish());
    sut.close();
  }

  void expect_is_map_of(const Session& session, const mapping::Mapper& mapper) {
    ASSERT_EQ(session.keyframes.size(), mapper.keyframes().size());
    for (std::size_t i = 0; i < session.keyframes.size(); ++i) {
      ASSERT_EQ(session.keyframes[i].id, mapper.keyframes()[i].id);
      const geometry::Vector6d off = boxminus(session.T_map_base[i], mapper.T_map_base(i));
      EXPECT_LT(off.head<3>().norm(), 1.01e-3);
      EXPECT_LT(off.tail<3>().norm(), 1.01e-4);
      EXPECT_EQ(session.keyframes[i].cloud_level.size(), mapper.keyframes().cloud_points(i));
    }
  }
};

TEST_F(SessionRecorderTest, KeepsTheMapAsTheLoopsHaveCorrectedIt) {
  mapping::Mapper mapper(circles::small());

  drive(mapper, 240);

  const Session session = read_session(folder_);
  expect_is_map_of(session, mapper);
  EXPECT_GT(mapper.correction_id(), 0U);
  std::size_t believed = 0;
  for (const SessionLoop& loop : session.loops) {
    believed += loop.accepted ? 1 : 0;
  }
  EXPECT_EQ(believed, mapper.counts().accepted() - mapper.counts().removed());
  EXPECT_EQ(session.loops.size(), mapper.counts().verified());
}

TEST_F(SessionRecorderTest, KeepsWhatTheMapKeepsAtItsLimit) {
  mapping::MapperConfig config = circles::small();
  config.keyframes = 20;
  config.kept_at_limit = 8;
  mapping::Mapper mapper(config);

  drive(mapper, 240);

  EXPECT_GT(mapper.retired(), 0U);
  expect_is_map_of(read_session(folder_), mapper);
}

}  // namespace
}  // namespace slamd::storage
