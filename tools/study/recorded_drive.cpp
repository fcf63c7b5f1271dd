#include "tools/study/recorded_drive.hpp"

#include <stdexcept>

#include "core/evaluation/alignment.hpp"
#include "core/evaluation/errors.hpp"
#include "tools/replay/output.hpp"
#include "tools/simulate/simulated_source.hpp"

namespace slamd::study {

namespace {

std::vector<sensor::ImuSample> samples_of(const simulate::Scene& scene) {
  simulate::InertialSensor sensor = scene.imu();
  std::vector<sensor::ImuSample> samples;
  double t_s = 0.0;
  simulate::InertialReading reading;
  while (sensor.next(t_s, reading)) {
    samples.push_back(simulate::written_sample(t_s, reading));
  }
  return samples;
}

double ape_rmse_m(const simulate::Scene& scene, const replay::Run& run) {
  const auto pairs = evaluation::associate_interpolated(
      simulate::truth_of(scene.motion()), replay::trajectory_of(run), std::chrono::seconds(1));
  evaluation::Similarity similarity = evaluation::align(pairs, evaluation::Alignment::kYaw);
  try {
    similarity = evaluation::align(pairs, evaluation::Alignment::kSe3);
  } catch (const std::invalid_argument&) {
    // A straight path, as through a tunnel: its roll cannot be found.
  }
  return evaluation::statistics_of(evaluation::ape_translation_m(pairs, similarity)).rmse;
}

}  // namespace

RecordedDrive record(const simulate::Drive& drive, std::vector<std::string> overrides) {
  overrides.emplace_back("wheel.use=false");
  const simulate::Scene scene(drive);
  simulate::SimulatedSource source(scene);
  const configuration::Configuration configuration = simulate::configuration_of(drive, overrides);
  RecordedDrive recorded;
  recorded.config = configuration::resolved_odometry(configuration);
  replay::Sinks sinks;
  sinks.scan = [&](const replay::ScanRecord& record, const scan::DeskewedScan& scan, const odometry::MotionStep&) {
    recorded.scans.push_back(scan);
    recorded.T_odom_imu.push_back(record.odometry.T_odom_imu);
  };
  const replay::Run run = replay::replay(configuration, source, sinks);
  if (!run.alignment) {
    throw std::runtime_error(drive.world +
                             ": the drive is too short for the inertial sensor to be levelled");
  }
  recorded.start = *run.alignment;
  recorded.imu = samples_of(scene);
  recorded.imu_errors = drive.imu_errors;
  recorded.imu_rate_hz = drive.imu_rate_hz;
  recorded.ape_rmse_m = ape_rmse_m(scene, run);
  return recorded;
}

}  // namespace slamd::study
