#include "tools/evaluate/evaluate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <memory>

#include <nlohmann/json.hpp>

#include "core/geometry/so3.hpp"
#include "drivers/recording/tum.hpp"
#include "drivers/storage/session_writer.hpp"
#include "tests/scratch/scratch_folder.hpp"
#include "tools/evaluate/loops.hpp"

namespace slamd::evaluate {
namespace {

using evaluation::Trajectory;
using geometry::Se3;
using nlohmann::json;
using scratch::message_of;

/// A figure of eight of some 170 m with hills, 10 poses a second.
Trajectory eight() {
  Trajectory trajectory;
  for (int i = 0; i <= 600; ++i) {
    const double a = 2.0 * M_PI * i / 600.0;
    const Eigen::Vector3d p(30.0 * std::sin(a), 15.0 * std::sin(2.0 * a), 0.5 * std::sin(3.0 * a));
    const double yaw = std::atan2(30.0 * std::cos(2.0 * a), 30.0 * std::cos(a));
    trajectory.push_back({Stamp{} + std::chrono::milliseconds(1'790'000'000'000 + 100 * i),
                          Se3(geometry::rotation_from_rpy({0.01, -0.02, yaw}), p)});
  }
  return trajectory;
}

/// The trajectory seen from another world frame, T_other_world.
Trajectory seen_from(const Se3& T_other_world, Trajectory trajectory) {
  for (evaluation::TimedPose& pose : trajectory) {
    pose.T = T_other_world * pose.T;
  }
  return trajectory;
}

class Evaluate : public scratch::ScratchFolder {
 protected:
  std::string written(const std::string& name, const Trajectory& trajectory) const {
    const std::filesystem::path file = folder_ / name;
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "wb"), std::fclose);
    for (const evaluation::TimedPose& pose : trajectory) {
      recording::write_tum_line(stream.get(), pose.stamp, pose.T);
    }
    return file;
  }

  json compared(const Trajectory& reference, const Trajectory& estimate, Options options = {}) const {
    options.reference = written("reference.tum", reference);
    options.estimate = written("estimate.tum", estimate);
    options.json = true;
    return json::parse(evaluate(options));
  }

  /// What comparing two files of these texts is refused with.
  std::string refusal_of(const std::string& reference, const std::string& estimate) const {
    Options options;
    options.reference = write("reference.tum", reference);
    options.estimate = write("estimate.tum", estimate);
    return message_of<std::runtime_error>([&] { evaluate(options); });
  }
};

TEST_F(Evaluate, FindsNoErrorBetweenATrajectoryAndItself) {
  const json sut = compared(eight(), eight());

  EXPECT_EQ(sut["pairs"], 601);
  EXPECT_NEAR(sut["reference_path_m"].get<double>(), 183.0, 5.0);
  for (const char* alignment : {"se3", "yaw", "none"}) {
    EXPECT_LT(sut["ape_m"][alignment]["max"].get<double>(), 1e-6) << alignment;
  }
  EXPECT_LT(sut["rpe_m"]["max"].get<double>(), 1e-5);
  EXPECT_LT(sut["tilt_deg"]["max"].get<double>(), 1e-4);
  EXPECT_LT(sut["end_drift_m"].get<double>(), 1e-5);
  EXPECT_GT(sut["kitti"]["segments"], 0);
  EXPECT_LT(sut["kitti"]["translation_percent"].get<double>(), 1e-5);
}

TEST_F(Evaluate, TakesAnotherWorldFrameForAnErrorOnlyWithoutAlignment) {
  const Se3 T_other_world(geometry::rotation_from_rpy({0.0, 0.0, 1.0}), {3.0, 4.0, 0.0});

  const json sut = compared(eight(), seen_from(T_other_world, eight()));

  EXPECT_LT(sut["ape_m"]["se3"]["max"].get<double>(), 1e-5);
  EXPECT_LT(sut["ape_m"]["yaw"]["max"].get<double>(), 1e-5);
  EXPECT_GT(sut["ape_m"]["none"]["rmse"].get<double>(), 3.0);
  EXPECT_LT(sut["rpe_m"]["max"].get<double>(), 1e-5);
}

TEST_F(Evaluate, TakesATiltedWorldForTiltWhichYawCannotAlign) {
  const double tilt_rad = 2.0 * M_PI / 180.0;
  const Se3 T_other_world(geometry::rotation_from_rpy({tilt_rad, 0.0, 0.5}), {0.0, 0.0, 0.0});

  const json sut = compared(eight(), seen_from(T_other_world, eight()));

  EXPECT_LT(sut["ape_m"]["se3"]["max"].get<double>(), 1e-5);
  EXPECT_GT(sut["ape_m"]["yaw"]["max"].get<double>(), 0.3);
  EXPECT_NEAR(sut["tilt_deg"]["mean"].get<double>(), 2.0, 0.05);
}

TEST_F(Evaluate, MeasuresDriftAtTheEndInMetresAndAsAShareOfThePath) {
  Trajectory estimate = eight();
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    estimate[i].T.translation().z() += 0.6 * static_cast<double>(i) / 600.0;
  }

  const json sut = compared(eight(), estimate);

  EXPECT_NEAR(sut["end_drift_m"].get<double>(), 0.6, 0.01);
  EXPECT_NEAR(sut["end_drift_percent"].get<double>(),
              100.0 * sut["end_drift_m"].get<double>() / sut["reference_path_m"].get<double>(), 1e-9);
}

TEST_F(Evaluate, InterpolatesTheReferenceAtTheEstimatesStamps) {
  const Trajectory truth = eight();
  Trajectory every_fourth;
  for (std::size_t i = 0; i < truth.size(); i += 4) {
    every_fourth.push_back(truth[i]);
  }

  const json sut = compared(every_fourth, truth);

  EXPECT_EQ(sut["pairs"], 601);
  EXPECT_LT(sut["ape_m"]["none"]["max"].get<double>(), 0.03);  // what a chord of 1.2 m leaves out of a curve
}

TEST_F(Evaluate, LeavesOutWhatFallsIntoAGapOfTheReference) {
  Trajectory reference = eight();
  reference.erase(reference.begin() + 100, reference.begin() + 200);

  EXPECT_EQ(compared(reference, eight())["pairs"], 501);
  Options patient;
  patient.max_gap_s = 20.0;
  EXPECT_EQ(compared(reference, eight(), patient)["pairs"], 601);
}

TEST_F(Evaluate, SaysThatAStraightPathGivesNoRotation) {
  Trajectory line;
  for (int i = 0; i < 50; ++i) {
    line.push_back({Stamp{} + std::chrono::seconds(i), Se3(Eigen::Matrix3d::Identity(), {double(i), 0.0, 0.0})});
  }

  EXPECT_TRUE(compared(line, line)["ape_m"]["se3"].is_null());
  Options table;
  table.reference = written("reference.tum", line);
  table.estimate = table.reference;
  EXPECT_NE(evaluate(table).find("the path is straight"), std::string::npos);
}

TEST_F(Evaluate, ChoosesRpesPairsByFramesMetresOrDegrees) {
  Options frames;
  frames.unit = "frames";
  frames.rule.delta = 100.0;
  Options metres;
  metres.rule.delta = 20.0;
  Options degrees;
  degrees.unit = "deg";
  degrees.rule.delta = 45.0;

  EXPECT_EQ(compared(eight(), eight(), frames)["rpe_m"]["count"], 6);
  EXPECT_NEAR(compared(eight(), eight(), metres)["rpe_m"]["count"].get<double>(), 9.0, 1.0);
  EXPECT_GE(compared(eight(), eight(), degrees)["rpe_m"]["count"], 8);
}

TEST_F(Evaluate, ReadsKittiRowsWithTheirTimes) {
  const Trajectory truth = eight();
  std::string rows;
  std::string times;
  for (const evaluation::TimedPose& pose : truth) {
    char text[400];
    const Eigen::Matrix3d& R = pose.T.rotation();
    const Eigen::Vector3d& p = pose.T.translation();
    std::snprintf(text, sizeof text, "%.9f %.9f %.9f %.9f %.9f %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n", R(0, 0), R(0, 1),
                  R(0, 2), p.x(), R(1, 0), R(1, 1), R(1, 2), p.y(), R(2, 0), R(2, 1), R(2, 2), p.z());
    rows += text;
    std::snprintf(text, sizeof text, "%.1f\n", to_seconds(pose.stamp.time_since_epoch()));
    times += text;
  }
  Options options;
  options.reference = write("rows.txt", rows);
  options.estimate = written("estimate.tum", truth);
  options.times = write("times.txt", times);
  options.json = true;

  EXPECT_LT(json::parse(evaluate(options))["ape_m"]["none"]["max"].get<double>(), 1e-5);
  options.times.clear();
  EXPECT_EQ(message_of<recording::RecordingError>([&] { evaluate(options); }),
            options.reference + ": holds KITTI rows, which have no stamps: give them with --times FILE");
}

TEST_F(Evaluate, PrintsEachMeasureInATable) {
  Options options;
  options.reference = written("reference.tum", eight());
  options.estimate = options.reference;

  const std::string sut = evaluate(options);

  for (const char* row : {"APE, SE(3)-aligned", "APE, yaw-aligned", "APE, unaligned", "RPE translation", "RPE rotation",
                          "tilt, yaw-aligned", "KITTI segments", "end drift"}) {
    EXPECT_NE(sut.find(row), std::string::npos) << row;
  }
}

TEST_F(Evaluate, TellsWhetherCovariancesCanBeBelieved) {
  const Trajectory truth = eight();
  Trajectory estimate = truth;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    estimate[i].T.translation().z() += i % 2 == 0 ? 0.0 : 0.02;
  }
  std::string rows = "timestamp_ns,since_ns,P00,P01,P02,P03,P04,P05,P11,P12,P13,P14,P15,P22,P23,P24,P25,P33,P34,P35,P44,P45,P55\n";
  for (std::size_t i = 31; i < truth.size(); ++i) {
    rows += std::to_string(truth[i].stamp.time_since_epoch().count()) + ",3100000000" +
            ",1e-4,0,0,0,0,0,1e-4,0,0,0,0,1e-4,0,0,0,1e-6,0,0,1e-6,0,1e-6\n";
  }
  Options options;
  options.motions = write("motions.csv", rows);

  const json sut = compared(truth, estimate, options);

  EXPECT_EQ(sut["motions"]["motions"], truth.size() - 31);
  EXPECT_NEAR(sut["motions"]["z"]["mean"].get<double>(), 4.0, 0.05);  // 2 cm where 1 cm was claimed
  EXPECT_LT(sut["motions"]["z"]["inside_95"].get<double>(), 0.1);
  EXPECT_GT(sut["motions"]["rotation"]["inside_95"].get<double>(), 0.99);
  options.reference = folder_ / "reference.tum";
  options.estimate = folder_ / "estimate.tum";
  EXPECT_NE(evaluate(options).find("within 95 %"), std::string::npos);
}

TEST_F(Evaluate, JudgesTheLoopsOfASessionByTheTruth) {
  const Trajectory truth = eight();  // it ends where it began
  storage::SessionWriter writer(folder_ / "session", {}, {});
  for (const std::size_t i : {0U, 300U, 600U}) {
    storage::SessionKeyframe keyframe;
    keyframe.id = static_cast<graph::KeyframeId>(i);
    keyframe.stamp = truth[i].stamp;
    writer.write(keyframe);
  }
  Se3 wrong = truth[0].T.inverse() * truth[300].T;
  wrong.translation().x() += 2.0;
  const geometry::Matrix6d information = geometry::Matrix6d::Identity();
  writer.write(storage::SessionLoop{1, 0, 600, {truth[0].T.inverse() * truth[600].T, information}, true});
  writer.write(storage::SessionLoop{2, 0, 300, {wrong, information}, true});
  writer.write(storage::SessionLoop{3, 0, 300, {Se3(), information}, false});  // the graph does not believe it
  writer.close();

  const json sut = json::parse(evaluate_loops({.truth = written("truth.tum", truth), .session = folder_ / "session", .json = true}));

  EXPECT_EQ(sut["loops"], 2);
  EXPECT_EQ(sut["wrong"], 1);
  EXPECT_NEAR(sut["worst_m"].get<double>(), 2.0, 1e-6);
  EXPECT_NEAR(sut["recall"].get<double>(), 0.36, 0.1) << "the end, not the crossing in the middle";
  EXPECT_NE(evaluate_loops({.truth = folder_ / "truth.tum", .session = folder_ / "session"}).find("1 wrong"), std::string::npos);
}

TEST_F(Evaluate, SaysInOneLineWhatIsWrongWithAFile) {
  const std::string good = "1.0 0 0 0 0 0 0 1\n2.0 1 0 0 0 0 0 1\n3.0 1 1 0 0 0 0 1\n";
  const std::string estimate = (folder_ / "estimate.tum").string();

  EXPECT_EQ(refusal_of(good, ""), estimate + ": holds no poses");
  EXPECT_EQ(refusal_of(good, "# nothing\n\n"), estimate + ": holds no poses");
  EXPECT_EQ(refusal_of(good, "1.0 0 0 0 0 0 0 1\n1.0 0 0 0 0 0 0 1\n"), estimate + ": pose 2 is not later than the one before it");
  EXPECT_EQ(refusal_of(good, "1.0 0 0 zero 0 0 0 1\n"), estimate + ": line 1: is not 7 finite numbers");
  EXPECT_EQ(refusal_of(good, "5.0 0 0 0 0 0 0 1\n6.0 0 0 0 0 0 0 1\n"),
            (folder_ / "reference.tum").string() + " and " + estimate + " have no time in common");
}

}  // namespace
}  // namespace slamd::evaluate
