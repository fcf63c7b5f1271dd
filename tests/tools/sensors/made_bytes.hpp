#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "core/base/bytes.hpp"
#include "core/sensor/imu_reading.hpp"
#include "drivers/imu/mip.hpp"
#include "drivers/imu/xsens.hpp"
#include "drivers/livox/sdk1_frame.hpp"
#include "drivers/livox/sdk1_messages.hpp"
#include "drivers/livox/sdk2_frame.hpp"
#include "drivers/livox/sdk2_header.hpp"
#include "tools/sensors/lidar_watch.hpp"

namespace slamd::sensors {

using Bytes = std::vector<std::byte>;

inline constexpr Stamp kBegin{std::chrono::seconds{1'700'000'000}};
inline constexpr std::uint32_t kHost = 0x0A4D0001;    // 10.77.0.1
inline constexpr std::uint32_t kSensor = 0x0A4D0002;  // 10.77.0.2
inline const std::vector<transport::Interface> kInterfaces{{1, 0x7F000001, 0xFF000000, false}, {2, kHost, 0xFFFFFF00, true}};

template <typename Range>
Bytes bytes_of(const Range& range) {
  return {range.begin(), range.end()};
}

inline Bytes text_bytes(std::string_view text) { return bytes_of(std::as_bytes(std::span(text))); }

inline Bytes sdk1_broadcast(std::string_view code, std::uint8_t type = 7) {
  const livox::Payload payload = livox::Sdk1Broadcast{livox::DeviceCode::of(code), type, 0}.bytes();
  return bytes_of(livox::write_sdk1_frame({livox::Sdk1FrameType::kMessage, 0, livox::Sdk1Command::kBroadcast, payload.view()}));
}

inline Bytes sdk2_answer(std::string_view serial, std::uint8_t type = 9) {
  const livox::Payload payload = livox::Sdk2Discovery{0, type, livox::DeviceCode::of(serial), kSensor, 56100}.bytes();
  return bytes_of(livox::write_sdk2_frame({1, livox::Sdk2Command::kDiscovery, true, true, payload.view()}));
}

/// What an SDK2 device answers to the question where it sends to, and which clock it follows.
inline Bytes sdk2_state(std::uint32_t sends_to, std::uint8_t sync) {
  livox::Sdk2ValueWriter values(0);
  values.add(livox::Sdk2Key::kPointDestination, livox::Sdk2Destination{sends_to, 56301, 56300}.bytes().view());
  values.add(livox::Sdk2Key::kSyncType, sync);
  return bytes_of(livox::write_sdk2_frame({2, livox::Sdk2Command::kGetParameters, true, true, values.payload()}));
}

/// An inertial sample of an Avia, level, with a status code.
inline Bytes sdk1_sample(std::uint32_t status, std::uint64_t stamp_ns) {
  Bytes bytes(livox::DataHeader::kBytes + 24);
  bytes[0] = std::byte{livox::DataHeader::kVersion};
  store_le(bytes, 4, status);
  store_le<std::uint8_t>(bytes, 8, 0);
  store_le<std::uint8_t>(bytes, 9, 6);
  store_le(bytes, 10, stamp_ns);
  store_le(bytes, 18 + 20, 1.0F);  // g, along z
  return bytes;
}

/// An inertial sample of a Mid-360, level.
inline Bytes sdk2_sample(std::uint8_t time_type, std::uint16_t number) {
  Bytes bytes(livox::Sdk2Header::kBytes + 24);
  store_le(bytes, livox::Sdk2Header::kBytes + 20, 1.0F);  // g, along z
  livox::Sdk2Header header;
  header.points = 1;
  header.number = number;
  header.data_type = 0;
  header.time_type = time_type;
  livox::seal_sdk2_packet(header, bytes);
  return bytes;
}

/// A packet of a Velodyne: no returns.
inline Bytes velodyne_packet(std::uint8_t product = 0x22) {
  Bytes bytes(1206);
  for (std::size_t block = 0; block < 12; ++block) {
    store_le<std::uint16_t>(bytes, 100 * block, 0xEEFF);
    store_le(bytes, 100 * block + 2, static_cast<std::uint16_t>(40 * block));
  }
  store_le<std::uint8_t>(bytes, 1204, 0x37);
  store_le(bytes, 1205, product);
  return bytes;
}

inline Bytes position_packet(std::uint8_t pps, std::string_view sentence) {
  Bytes bytes(512);
  store_le(bytes, 0xCA, pps);
  const Bytes text = text_bytes(sentence);
  std::copy(text.begin(), text.end(), bytes.begin() + 0xCE);
  return bytes;
}

inline Bytes xsens_message(std::uint32_t ticks, const Eigen::Vector3d& force_mps2 = {0.0, 0.0, 9.81}) {
  constexpr imu::XsensOutput kOutputs[] = {{imu::mt::kSampleTimeFine, 0}, {imu::mt::kAcceleration, 0}, {imu::mt::kRateOfTurn, 0}};
  return bytes_of(imu::write_sample(kOutputs, {.ticks = ticks, .specific_force_mps2 = force_mps2}));
}

inline Bytes mip_packet(std::uint64_t time_ns) {
  constexpr imu::MipOutput kOutputs[] = {{imu::mip::kReferenceTime}, {imu::mip::kAcceleration}, {imu::mip::kTurnRate}};
  return bytes_of(imu::write_sample(kOutputs, {.reference_time_ns = time_ns, .specific_force_mps2 = {0.0, 0.0, 9.81}}));
}

inline Arrival arrival_of(const Bytes& bytes, std::uint16_t port, std::uint32_t source = kSensor, Stamp received = kBegin) {
  return {bytes, source, port, received};
}

inline sensor::ImuReading reading_of(Duration device_time, const Eigen::Vector3d& force_mps2) {
  sensor::ImuReading reading;
  reading.device_stamp = DeviceStamp{} + device_time;
  reading.specific_force_mps2 = force_mps2;
  return reading;
}

}  // namespace slamd::sensors
