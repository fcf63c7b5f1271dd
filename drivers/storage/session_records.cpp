#include "drivers/storage/session_records.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/bytes.hpp"
#include "core/base/crc32.hpp"
#include "core/mapping/cloud_pool.hpp"

namespace slamd::storage {

using geometry::Matrix6d;
using geometry::Se3;

namespace {

constexpr float kStep_m = mapping::CloudPool::kStep_m;
constexpr double kFarthest_m = 1e7;  // a map is no larger
constexpr std::size_t kMaxText = 63;
constexpr std::uint8_t kHasGravity = 1;
constexpr std::uint8_t kIsAccepted = 1;

/// Appends numbers.
class Writer {
 public:
  template <detail::Number T>
  void put(T value) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + sizeof(T));
    store_le(bytes_, at, value);
  }
  void put(const Eigen::Vector3d& v) {
    put(v.x());
    put(v.y());
    put(v.z());
  }
  void put(const Eigen::Quaterniond& q) {
    put(q.w());
    put(q.x());
    put(q.y());
    put(q.z());
  }
  void put(const Se3& T) {
    put(T.translation());
    put(T.quaternion());
  }
  /// The upper triangle, row by row.
  void put(const Matrix6d& symmetric) {
    for (int i = 0; i < 6; ++i) {
      for (int j = i; j < 6; ++j) {
        put(symmetric(i, j));
      }
    }
  }
  void put(const graph::BetweenFactor& factor) {
    put(factor.T_a_b);
    put(factor.information);
  }
  void put(const std::string& text) {
    const std::size_t size = std::min(text.size(), kMaxText);
    put(static_cast<std::uint8_t>(size));
    for (std::size_t i = 0; i < size; ++i) {
      put(static_cast<std::uint8_t>(text[i]));
    }
  }

  RecordBytes take() { return std::move(bytes_); }

 private:
  RecordBytes bytes_;
};

/// Takes numbers from the front. Errors: SessionContentError where there are too few bytes, or a number is none.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <detail::Number T>
  T number() {
    if (bytes_.size() < at_ + sizeof(T)) {
      throw SessionContentError("is too short for its kind");
    }
    const T value = load_le<T>(bytes_, at_);
    at_ += sizeof(T);
    return value;
  }
  double finite() {
    const double value = number<double>();
    if (!std::isfinite(value)) {
      throw SessionContentError("holds a number that is none");
    }
    return value;
  }
  Eigen::Vector3d vector() {
    const double x = finite();
    const double y = finite();
    return {x, y, finite()};
  }
  Eigen::Matrix3d rotation() {
    Eigen::Quaterniond q;
    q.w() = finite();
    q.vec() = vector();
    if (std::abs(q.norm() - 1.0) > 1e-6) {
      throw SessionContentError("holds a rotation that is none");
    }
    return q.normalized().toRotationMatrix();
  }
  Se3 pose() {
    const Eigen::Vector3d p = vector();
    if (!(p.cwiseAbs().maxCoeff() <= kFarthest_m)) {
      throw SessionContentError("lies beyond all bounds");
    }
    return {rotation(), p};
  }
  graph::BetweenFactor factor() {
    graph::BetweenFactor result;
    result.T_a_b = pose();
    for (int i = 0; i < 6; ++i) {
      for (int j = i; j < 6; ++j) {
        result.information(i, j) = result.information(j, i) = finite();
      }
    }
    return result;
  }
  std::string text() {
    std::string result(number<std::uint8_t>(), ' ');
    for (char& c : result) {
      c = static_cast<char>(number<std::uint8_t>());
    }
    return result;
  }
  /// How many items of a size are left, if that is exactly what is left.
  std::size_t items(std::size_t item_bytes) {
    const std::size_t count = number<std::uint32_t>();
    if (bytes_.size() - at_ != count * item_bytes) {
      throw SessionContentError("is of another length than it says");
    }
    return count;
  }
  void end() const {
    if (at_ != bytes_.size()) {
      throw SessionContentError("is too long for its kind");
    }
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
};

/// A point in steps; nothing beyond their reach.
std::optional<std::array<std::int16_t, 3>> in_steps(const Eigen::Vector3f& p) {
  std::array<std::int16_t, 3> steps{};
  for (int k = 0; k < 3; ++k) {
    const float value = std::round(p[k] / kStep_m);
    if (!(std::abs(value) <= static_cast<float>(std::numeric_limits<std::int16_t>::max()))) {
      return std::nullopt;
    }
    steps[static_cast<std::size_t>(k)] = static_cast<std::int16_t>(value);
  }
  return steps;
}

}  // namespace

RecordBytes payload_of(const SessionBegin& begin) {
  Writer out;
  out.put(begin.session);
  out.put(begin.segment);
  out.put(begin.sensor);
  out.put(begin.software);
  return out.take();
}

SessionBegin read_begin(std::span<const std::byte> payload) {
  Reader in(payload);
  SessionBegin begin;
  begin.session = in.number<std::uint64_t>();
  begin.segment = in.number<std::uint32_t>();
  begin.sensor = in.text();
  begin.software = in.text();
  in.end();
  return begin;
}

RecordBytes payload_of(const SessionKeyframe& keyframe) {
  std::vector<std::array<std::int16_t, 3>> points;
  points.reserve(keyframe.cloud_level.size());
  for (const Eigen::Vector3f& p : keyframe.cloud_level) {
    if (const auto steps = in_steps(p)) {
      points.push_back(*steps);
    }
  }
  Writer out;
  out.put(keyframe.id);
  out.put(keyframe.submap);
  out.put(std::int64_t{keyframe.stamp.time_since_epoch().count()});
  out.put(keyframe.T_odom_base);
  out.put(Eigen::Quaterniond(keyframe.R_base_level));
  out.put(keyframe.path_m);
  out.put(keyframe.median_range_m);
  out.put(keyframe.odometry);
  out.put(keyframe.gravity ? kHasGravity : std::uint8_t{0});
  const graph::GravityFactor gravity = keyframe.gravity.value_or(graph::GravityFactor{});
  out.put(gravity.up_base);
  out.put(gravity.std_rad);
  out.put(static_cast<std::uint32_t>(points.size()));
  for (const auto& point : points) {
    for (const std::int16_t step : point) {
      out.put(step);
    }
  }
  return out.take();
}

SessionKeyframe read_keyframe(std::span<const std::byte> payload) {
  Reader in(payload);
  SessionKeyframe keyframe;
  keyframe.id = in.number<std::uint32_t>();
  keyframe.submap = in.number<std::uint32_t>();
  keyframe.stamp = Stamp(Duration(in.number<std::int64_t>()));
  keyframe.T_odom_base = in.pose();
  keyframe.R_base_level = in.rotation();
  keyframe.path_m = in.finite();
  keyframe.median_range_m = in.finite();
  keyframe.odometry = in.factor();
  const bool has_gravity = (in.number<std::uint8_t>() & kHasGravity) != 0;
  graph::GravityFactor gravity;
  gravity.up_base = in.vector();
  gravity.std_rad = in.finite();
  if (has_gravity) {
    if (!(gravity.std_rad > 0.0) || std::abs(gravity.up_base.norm() - 1.0) > 1e-6) {
      throw SessionContentError("holds a vertical that is none");
    }
    keyframe.gravity = gravity;
  }
  const std::size_t points = in.items(3 * sizeof(std::int16_t));
  keyframe.cloud_level.reserve(points);
  for (std::size_t i = 0; i < points; ++i) {
    const float x = kStep_m * static_cast<float>(in.number<std::int16_t>());
    const float y = kStep_m * static_cast<float>(in.number<std::int16_t>());
    keyframe.cloud_level.emplace_back(x, y, kStep_m * static_cast<float>(in.number<std::int16_t>()));
  }
  return keyframe;
}

RecordBytes payload_of(const SessionLoop& loop) {
  Writer out;
  out.put(loop.id);
  out.put(loop.a);
  out.put(loop.b);
  out.put(loop.factor);
  out.put(loop.accepted ? kIsAccepted : std::uint8_t{0});
  return out.take();
}

SessionLoop read_loop(std::span<const std::byte> payload) {
  Reader in(payload);
  SessionLoop loop;
  loop.id = in.number<std::uint32_t>();
  loop.a = in.number<std::uint32_t>();
  loop.b = in.number<std::uint32_t>();
  if (loop.a >= loop.b) {
    throw SessionContentError("joins no earlier keyframe with a later one");
  }
  loop.factor = in.factor();
  loop.accepted = (in.number<std::uint8_t>() & kIsAccepted) != 0;
  in.end();
  return loop;
}

RecordBytes payload_of(std::span<const SessionPose> poses) {
  Writer out;
  out.put(static_cast<std::uint32_t>(poses.size()));
  for (const SessionPose& pose : poses) {
    out.put(pose.id);
    out.put(pose.T_map_base);
  }
  return out.take();
}

std::vector<SessionPose> read_poses(std::span<const std::byte> payload) {
  constexpr std::size_t kPoseBytes = sizeof(std::uint32_t) + 7 * sizeof(double);
  Reader in(payload);
  std::vector<SessionPose> poses(in.items(kPoseBytes));
  for (SessionPose& pose : poses) {
    pose.id = in.number<std::uint32_t>();
    pose.T_map_base = in.pose();
  }
  return poses;
}

RecordBytes payload_of_retired(graph::KeyframeId id) {
  Writer out;
  out.put(id);
  return out.take();
}

graph::KeyframeId read_retired(std::span<const std::byte> payload) {
  Reader in(payload);
  const auto id = in.number<std::uint32_t>();
  in.end();
  return id;
}

RecordBytes framed(const RecordFrame& frame) {
  SLAMD_ASSERT(frame.payload.size() <= RecordFrame::kMaxPayload);
  RecordBytes bytes(frame.bytes());
  store_le(bytes, 0, RecordFrame::kMagic);
  store_le(bytes, 4, static_cast<std::uint32_t>(frame.payload.size()));
  store_le(bytes, 8, static_cast<std::uint16_t>(frame.kind));
  store_le(bytes, 10, kSessionFormat);
  store_le(bytes, 12, frame.number);
  std::copy(frame.payload.begin(), frame.payload.end(), bytes.begin() + RecordFrame::kHeaderBytes);
  const std::size_t end = RecordFrame::kHeaderBytes + frame.payload.size();
  store_le(bytes, end, crc32(std::span(bytes).subspan(4, end - 4)));
  return bytes;
}

FrameVerdict read_frame(std::span<const std::byte> bytes, RecordFrame& frame) {
  if (bytes.size() < 4) {
    return FrameVerdict::kCut;
  }
  if (load_le<std::uint32_t>(bytes, 0) != RecordFrame::kMagic) {
    return FrameVerdict::kNoRecord;
  }
  if (bytes.size() < RecordFrame::kHeaderBytes + RecordFrame::kTrailerBytes) {
    return FrameVerdict::kCut;
  }
  const std::size_t size = load_le<std::uint32_t>(bytes, 4);
  if (size > RecordFrame::kMaxPayload) {
    return FrameVerdict::kNoRecord;
  }
  const std::size_t end = RecordFrame::kHeaderBytes + size;
  if (bytes.size() < end + RecordFrame::kTrailerBytes) {
    return FrameVerdict::kCut;
  }
  frame.kind = static_cast<SessionRecord>(load_le<std::uint16_t>(bytes, 8));
  frame.number = load_le<std::uint32_t>(bytes, 12);
  frame.payload = bytes.subspan(RecordFrame::kHeaderBytes, size);
  if (crc32(bytes.subspan(4, end - 4)) != load_le<std::uint32_t>(bytes, end)) {
    return FrameVerdict::kDamaged;
  }
  return load_le<std::uint16_t>(bytes, 10) == kSessionFormat ? FrameVerdict::kGood : FrameVerdict::kNewerFormat;
}

}  // namespace slamd::storage
