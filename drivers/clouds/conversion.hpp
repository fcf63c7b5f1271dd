#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/stamp.hpp"
#include "core/sensor/point.hpp"
#include "drivers/clouds/lines.hpp"
#include "drivers/clouds/point_time.hpp"
#include "drivers/clouds/raw_cloud.hpp"

namespace slamd::clouds {

/// A cloud as points, still without a stamp.
struct Cloud {
  std::vector<sensor::Point> points;  // offset_ns from first_time
  std::uint64_t empty = 0;            // points without a return: not finite, or at the origin
  bool has_time = false;
  Duration first_time{};       // of the earliest point, in the file's own time
  Duration span{};             // to the last point
  bool absolute_time = false;  // first_time counts from 1970
  LineSource lines = LineSource::kField;
};

/// Where a cloud lies in time.
struct ScanPlace {
  Stamp begin{};
  Stamp end{};  // behind the last point; of a compensated cloud: its stamp
  bool by_points =
      false;  // the stamp was not used: the points' own times count from 1970, or there is no stamp
};

/// Places a cloud in time. With per-point time it begins at its earliest point: at the point's own
/// time where that counts from 1970, else at the stamp plus the point's offset (negative where
/// stamps are at the end of a scan). Without, it ends at its stamp and begins `period` before.
/// `fallback` is the end of the scan where nothing tells.
ScanPlace place_in_time(const Cloud& cloud,
                        std::optional<Stamp> stamp,
                        Stamp fallback,
                        Duration period);

/// Turns the columns of cloud files into points.
///
/// Fields, by name: x, y, z; intensity, i, reflectivity or reflectance; a time field
/// (point_time.hpp); ring, line, channel, laser_id or laser (else see LineSource); tag; echo,
/// return or return_number. Names ignore case. Intensity: when no value exceeds 1 and the field is
/// a float it counts as 0..1 and is scaled to 0..255, otherwise it is cut to 0..255. Time: the unit
/// is found by its magnitude in the first cloud that tells, and kept for those that follow; a time
/// field in which all times are equal is no time.
class CloudConverter {
 public:
  /// `use_time` false ignores the time field: the clouds are compensated already.
  explicit CloudConverter(bool use_time) : use_time_(use_time) {}

  /// Errors: kNoCoordinates, kBadTime.
  std::optional<CloudRefusal> convert(RawCloud& raw, Cloud& cloud);

 private:
  std::optional<CloudRefusal> set_times(const RawCloud& raw, Cloud& cloud);

  bool use_time_;
  std::optional<TimeUnit> unit_;
  std::vector<std::uint32_t> kept_;  // indices in the file of the points that are no empty ones
};

}  // namespace slamd::clouds
