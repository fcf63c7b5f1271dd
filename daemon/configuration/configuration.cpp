#include "daemon/configuration/configuration.hpp"

namespace slamd::configuration {

namespace {

/// The Avia's own inertial sensor, seen from its lidar frame; axes parallel.
/// Source: Livox SDK1 protocol; the lidar's origin lies at (41.65, 23.26, −28.40) mm in the imu frame.
const Eigen::Vector3d kAviaImuInLidar_m{-0.04165, -0.02326, 0.0284};

/// The Mid-360's, likewise. Source: Livox SDK2 protocol.
const Eigen::Vector3d kMid360ImuInLidar_m{0.011, 0.02329, -0.04412};

}  // namespace

const char* name_of(LidarModel model) {
  switch (model) {
    case LidarModel::kVlp16: return "vlp16";
    case LidarModel::kVlp16HiRes: return "vlp16_hires";
    case LidarModel::kVlp32c: return "vlp32c";
    case LidarModel::kHdl32e: return "hdl32e";
    case LidarModel::kLivoxAvia: return "livox_avia";
    case LidarModel::kLivoxMid360: return "livox_mid360";
    case LidarModel::kPoints: return "points";
  }
  return "?";
}

bool is_livox(LidarModel model) { return model == LidarModel::kLivoxAvia || model == LidarModel::kLivoxMid360; }

int LidarConfiguration::data_port() const {
  constexpr int kVelodynePort = 2368;
  return port == 0 && !is_livox(model) ? kVelodynePort : port;
}

int LidarConfiguration::listening_port() const {
  constexpr int kAviaPort = 56001;  // of the first device
  constexpr int kMid360Port = 56301;
  return port != 0 || !is_livox(model) ? data_port() : (model == LidarModel::kLivoxAvia ? kAviaPort : kMid360Port);
}

int LidarConfiguration::command_port() const {
  constexpr int kAviaPort = 55501;  // of the first device
  constexpr int kMid360Port = 56101;
  return device.command_port != 0 ? device.command_port : (model == LidarModel::kLivoxAvia ? kAviaPort : kMid360Port);
}

odometry::OdometryConfig resolved_odometry(const Configuration& configuration) {
  odometry::OdometryConfig result = configuration.odometry;
  result.use_imu = configuration.imu.enabled;
  result.T_base_lidar = configuration.lidar.T_base_lidar;
  if (!configuration.imu.enabled) {
    result.T_base_imu = geometry::Se3();
  } else if (configuration.imu.T_base_imu) {
    result.T_base_imu = *configuration.imu.T_base_imu;
  } else if (configuration.imu.source == "livox") {
    const bool avia = configuration.lidar.model == LidarModel::kLivoxAvia;
    result.T_base_imu = configuration.lidar.T_base_lidar *
                        geometry::Se3(Eigen::Matrix3d::Identity(), avia ? kAviaImuInLidar_m : kMid360ImuInLidar_m);
  }
  return result;
}

}  // namespace slamd::configuration
