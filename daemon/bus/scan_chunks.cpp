#include "daemon/bus/scan_chunks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/assert.hpp"
#include "core/base/bytes.hpp"
#include "core/base/crc32.hpp"

namespace slamd::bus {

namespace {

constexpr double kCentimetre_m = 0.01;

/// Continues a CRC over points as they stand in the messages: big-endian x, y, z.
std::uint32_t crc_of(std::uint32_t crc, std::span<const ScanChunk::Point> points_cm) {
  for (const ScanChunk::Point& point : points_cm) {
    std::array<std::byte, sizeof(ScanChunk::Point)> bytes{};
    for (std::size_t i = 0; i < point.size(); ++i) {
      store_be(std::span<std::byte>(bytes), i * sizeof(point[i]), point[i]);
    }
    crc = crc32(bytes, crc);
  }
  return crc;
}

}  // namespace

ScanChunker::ScanChunker(std::size_t max_points) : max_points_(max_points), points_cm_(max_points) {
  SLAMD_ASSERT(max_points <= ScanChunk::kMaxChunks * ScanChunk::kPoints);
}

std::size_t ScanChunker::begin(const Scan& scan) {
  if (max_points_ == 0) {
    return 0;
  }
  // Whole centimetres, so that the points do not lie half a centimetre aside.
  const Eigen::Vector3d origin_odom = (scan.T_odom_base.translation() / kCentimetre_m).array().round() * kCentimetre_m;
  const std::size_t step = std::max<std::size_t>(1, (scan.points_imu.size() + max_points_ - 1) / max_points_);
  points_cm_.clear();
  for (std::size_t i = 0; i < scan.points_imu.size(); i += step) {
    const Eigen::Vector3d p_odom = scan.T_odom_imu * scan.points_imu[i].cast<double>();
    const Eigen::Vector3d p_cm = ((p_odom - origin_odom) / kCentimetre_m).array().round();
    if ((p_cm.cwiseAbs().array() <= std::numeric_limits<std::int16_t>::max()).all()) {  // false for NaN, too
      points_cm_.push_back({static_cast<std::int16_t>(p_cm.x()), static_cast<std::int16_t>(p_cm.y()),
                            static_cast<std::int16_t>(p_cm.z())});
    }
  }
  chunk_.scan_index = scan.scan_index;
  chunk_.stamp = scan.stamp;
  chunk_.T_odom_base = scan.T_odom_base;
  chunk_.origin_odom = origin_odom;
  chunk_.scan_crc32 = crc_of(0, points_cm_.view());
  chunk_.count =
      static_cast<std::uint16_t>(std::max<std::size_t>(1, (points_cm_.size() + ScanChunk::kPoints - 1) / ScanChunk::kPoints));
  return chunk_.count;
}

const ScanChunk& ScanChunker::chunk(std::size_t index) {
  SLAMD_ASSERT(index < chunk_.count);
  const std::size_t first = index * ScanChunk::kPoints;
  const std::size_t end = std::min(points_cm_.size(), first + ScanChunk::kPoints);
  chunk_.index = static_cast<std::uint16_t>(index);
  chunk_.points_cm.clear();
  for (std::size_t i = first; i < end; ++i) {
    chunk_.points_cm.push_back(points_cm_[i]);
  }
  return chunk_;
}

std::optional<AssembledScan> ScanAssembly::add(const ScanChunk& chunk) {
  if (head_ && chunk.scan_index == head_->scan_index && chunk.stamp == head_->stamp) {
    if (chunk.count != head_->count || chunk.scan_crc32 != head_->scan_crc32) {
      ++corrupt_;  // two senders on one channel, or worse
      return std::nullopt;
    }
  } else if (head_ && chunk.stamp <= head_->stamp) {
    ++late_;
    return std::nullopt;
  } else {
    begin(chunk);
  }
  if (seen_[chunk.index]) {
    ++late_;
    return std::nullopt;
  }
  seen_[chunk.index] = true;
  parts_[chunk.index] = chunk.points_cm;
  if (--missing_ > 0) {
    return std::nullopt;
  }
  std::uint32_t crc = 0;
  for (const auto& part : parts_) {
    crc = crc_of(crc, part.view());
  }
  if (crc != head_->scan_crc32) {
    ++corrupt_;
    return std::nullopt;
  }
  AssembledScan scan{
      .scan_index = head_->scan_index, .stamp = head_->stamp, .T_odom_base = head_->T_odom_base, .points_odom = {}};
  for (const auto& part : parts_) {
    for (const ScanChunk::Point& point : part) {
      scan.points_odom.emplace_back(head_->origin_odom +
                                    kCentimetre_m * Eigen::Vector3d(point[0], point[1], point[2]));
    }
  }
  return scan;
}

void ScanAssembly::begin(const ScanChunk& chunk) {
  incomplete_ += missing_ > 0 ? 1 : 0;
  head_ = chunk;
  parts_.resize(chunk.count);
  seen_.assign(chunk.count, false);
  missing_ = chunk.count;
}

}  // namespace slamd::bus
