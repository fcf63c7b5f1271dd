#pragma once

#include "made_bytes.hpp"
#include "tools/sensors/seen.hpp"

namespace slamd::sensors {

/// A computer at 10.77.0.1/24, with nothing connected.
inline Seen made_seen() {
  Seen seen;
  seen.listened_s = 10.0;
  seen.interfaces = kInterfaces;
  return seen;
}

/// One that looks for a host.
inline LidarSeen made_avia() {
  LidarSeen lidar;
  lidar.protocol = LidarProtocol::kSdk1;
  lidar.address = kSensor;
  lidar.code = "3JEDK380010Z391";
  lidar.type = "Livox Avia";
  lidar.model = configuration::LidarModel::kLivoxAvia;
  lidar.broadcasts = {10, 1};
  lidar.silent_s = 0.5;
  return lidar;
}

/// One that has answered.
inline LidarSeen made_mid360() {
  LidarSeen lidar = made_avia();
  lidar.protocol = LidarProtocol::kSdk2;
  lidar.code = "47MDL1234567890";
  lidar.type = "Livox Mid-360";
  lidar.model = configuration::LidarModel::kLivoxMid360;
  return lidar;
}

/// One that sends points, but no position packets.
inline LidarSeen made_vlp16() {
  LidarSeen lidar;
  lidar.protocol = LidarProtocol::kVelodyne;
  lidar.address = kSensor;
  lidar.type = "Velodyne VLP-16";
  lidar.model = configuration::LidarModel::kVlp16;
  lidar.packets = {7540, 754};
  lidar.points = {2'895'360, 289'536};
  lidar.port = 2368;
  return lidar;
}

/// At rest and level.
inline LineSeen made_xsens() {
  LineSeen line;
  line.device = "/dev/ttyUSB0";
  line.baud = 115'200;
  line.found = true;
  line.tongue = Tongue::kXsens;
  line.bytes = {50'000, 5'000};
  line.imu.samples = {1000, 100};
  line.imu.units = imu::Units::kSi;
  line.imu.mean_force_mps2 = {0.0, 0.0, 9.81};
  return line;
}

inline LineSeen made_receiver() {
  LineSeen line;
  line.device = "/dev/ttyACM0";
  line.baud = 38'400;
  line.found = true;
  line.tongue = Tongue::kGnss;
  line.gnss.sentences = {100, 10};
  line.gnss.fixes = {50, 5};
  line.gnss.good = {50, 5};
  line.gnss.satellites = 11;
  line.gnss.quality = 1;
  return line;
}

}  // namespace slamd::sensors
