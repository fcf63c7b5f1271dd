#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/base/stamp.hpp"
#include "core/geometry/se3.hpp"
#include "core/graph/between_factor.hpp"
#include "core/graph/graph_ids.hpp"
#include "core/graph/gravity_factor.hpp"

namespace slamd::storage {

// What a session file holds: docs/sessions.md has the bytes. Everything is little-endian.

inline constexpr std::uint16_t kSessionFormat = 1;

enum class SessionRecord : std::uint16_t {
  kBegin = 1,     // of a segment: which session, which part of it
  kKeyframe = 2,  // with its cloud
  kLoop = 3,      // as the graph judges it; the last word counts
  kPoses = 4,     // of keyframes in map, after a correction; the last word counts
  kRetired = 5,   // a keyframe that the map no longer holds
  kEnd = 6,       // the session was closed
};

/// The first record of each segment.
struct SessionBegin {
  std::uint64_t session = 0;   // the same in all segments of a session, another in each session; 0: of a replay
  std::uint32_t segment = 0;
  std::string sensor;          // the LiDAR's model; at most 63 bytes
  std::string software;        // who wrote it; at most 63 bytes

  bool operator==(const SessionBegin&) const = default;
};

/// A place of the map.  Frames: see mapping::Keyframe.  Units: m, rad.
struct SessionKeyframe {
  graph::KeyframeId id = 0;
  std::uint32_t submap = 0;
  Stamp stamp{};
  geometry::Se3 T_odom_base;
  Eigen::Matrix3d R_base_level = Eigen::Matrix3d::Identity();
  double path_m = 0.0;
  double median_range_m = 0.0;
  graph::BetweenFactor odometry;  // from the keyframe before it
  std::optional<graph::GravityFactor> gravity;
  std::vector<Eigen::Vector3f> cloud_level;  // kept to 5 mm, as mapping::CloudPool has it; beyond ±163 m left out
};

/// A loop: keyframe b seen from a, a < b, and whether the graph believes it.
struct SessionLoop {
  graph::LoopId id = 0;
  graph::KeyframeId a = 0;
  graph::KeyframeId b = 0;
  graph::BetweenFactor factor;
  bool accepted = false;
};

/// Where a keyframe lies in map.
struct SessionPose {
  graph::KeyframeId id = 0;
  geometry::Se3 T_map_base;
};

using RecordBytes = std::vector<std::byte>;

/// A record of sound checksum whose content is none; says what.
class SessionContentError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Write a record's payload.
RecordBytes payload_of(const SessionBegin& begin);
RecordBytes payload_of(const SessionKeyframe& keyframe);
RecordBytes payload_of(const SessionLoop& loop);
RecordBytes payload_of(std::span<const SessionPose> poses);
RecordBytes payload_of_retired(graph::KeyframeId id);

/// Read a payload back. Errors: SessionContentError where the length or a number cannot be.
SessionBegin read_begin(std::span<const std::byte> payload);
SessionKeyframe read_keyframe(std::span<const std::byte> payload);
SessionLoop read_loop(std::span<const std::byte> payload);
std::vector<SessionPose> read_poses(std::span<const std::byte> payload);
graph::KeyframeId read_retired(std::span<const std::byte> payload);

/// A record in its file: magic, payload's size, kind, format, number, payload, CRC-32 over all of it but the magic.
struct RecordFrame {
  static constexpr std::uint32_t kMagic = 0x4B4D4C53;  // "SLMK"
  static constexpr std::size_t kHeaderBytes = 16;
  static constexpr std::size_t kTrailerBytes = 4;
  static constexpr std::size_t kMaxPayload = 16U << 20U;

  SessionRecord kind{};
  std::uint32_t number = 0;  // counts the records of a session
  std::span<const std::byte> payload;

  std::size_t bytes() const { return kHeaderBytes + payload.size() + kTrailerBytes; }
};

/// Returns the record as it stands in the file.
RecordBytes framed(const RecordFrame& frame);

/// How the bytes at a place read as a record.
enum class FrameVerdict : std::uint8_t {
  kGood,
  kNoRecord,     // no magic, or a size beyond all bounds
  kCut,          // the file ends within it
  kDamaged,      // its checksum is another
  kNewerFormat,  // whole, but of a format that this release does not know
};

/// Reads the record that begins with these bytes; a damaged one, too.
FrameVerdict read_frame(std::span<const std::byte> bytes, RecordFrame& frame);

}  // namespace slamd::storage
