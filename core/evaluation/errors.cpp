#include "core/evaluation/errors.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace slamd::evaluation {

using geometry::Se3;

namespace {

std::vector<double> cumulative_path_m(std::span<const PosePair> pairs, bool of_reference) {
  std::vector<double> path(pairs.size(), 0.0);
  const auto place = [&](std::size_t i) {
    return of_reference ? pairs[i].reference.translation() : pairs[i].estimate.translation();
  };
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    path[i] = path[i - 1] + (place(i) - place(i - 1)).norm();
  }
  return path;
}

const Se3& pose_of(const PosePair& pair, bool of_reference) { return of_reference ? pair.reference : pair.estimate; }

std::vector<IndexPair> by_frames(std::size_t count, std::size_t delta, bool all_pairs) {
  std::vector<IndexPair> indices;
  for (std::size_t i = 0; delta > 0 && i + delta < count; i += all_pairs ? 1 : delta) {
    indices.push_back({i, i + delta});
  }
  return indices;
}

std::vector<IndexPair> chained(const std::vector<std::size_t>& ids) {
  std::vector<IndexPair> indices;
  for (std::size_t i = 1; i < ids.size(); ++i) {
    indices.push_back({ids[i - 1], ids[i]});
  }
  return indices;
}

std::vector<IndexPair> by_metres(std::span<const PosePair> pairs, const PairRule& rule) {
  if (!rule.all_pairs) {
    // Index 0 is not pushed: the first pair begins where the first delta is complete (a quirk that is kept).
    std::vector<std::size_t> ids;
    double since = 0.0;
    for (std::size_t i = 1; i < pairs.size(); ++i) {
      // Not the difference of summed paths: its rounding would miss steps of exactly delta.
      since += (pose_of(pairs[i], rule.from_reference).translation() -
                pose_of(pairs[i - 1], rule.from_reference).translation())
                   .norm();
      if (since >= rule.delta) {
        ids.push_back(i);
        since = 0.0;
      }
    }
    return chained(ids);
  }
  const std::vector<double> path = cumulative_path_m(pairs, rule.from_reference);
  std::vector<IndexPair> indices;
  const double tolerance = rule.delta * rule.relative_tolerance;
  for (std::size_t i = 0; i + 1 < pairs.size(); ++i) {
    std::size_t best = i + 1;
    for (std::size_t j = i + 1; j < pairs.size(); ++j) {
      if (std::abs(path[j] - path[i] - rule.delta) < std::abs(path[best] - path[i] - rule.delta)) {
        best = j;
      }
    }
    if (std::abs(path[best] - path[i] - rule.delta) <= tolerance) {
      indices.push_back({i, best});
    }
  }
  return indices;
}

std::vector<IndexPair> by_angle(std::span<const PosePair> pairs, const PairRule& rule) {
  const auto angle = [&](std::size_t i, std::size_t j) {
    return geometry::angle_between(pose_of(pairs[i], rule.from_reference).rotation(),
                                   pose_of(pairs[j], rule.from_reference).rotation());
  };
  if (!rule.all_pairs) {
    std::vector<std::size_t> ids{0};  // unlike metres, index 0 is a start here
    double since = 0.0;
    for (std::size_t i = 1; i < pairs.size(); ++i) {
      since += angle(i - 1, i);
      if (since >= rule.delta) {
        ids.push_back(i);
        since = 0.0;
      }
    }
    return chained(ids);
  }
  std::vector<IndexPair> indices;
  const double tolerance = rule.delta * rule.relative_tolerance;
  for (std::size_t i = 0; i + 1 < pairs.size(); ++i) {
    for (std::size_t j = i + 1; j < pairs.size(); ++j) {
      if (std::abs(angle(i, j) - rule.delta) <= tolerance) {
        indices.push_back({i, j});
      }
    }
  }
  return indices;
}

Se3 relative_error(const PosePair& first, const PosePair& second) {
  const Se3 reference = first.reference.inverse() * second.reference;
  const Se3 estimate = first.estimate.inverse() * second.estimate;
  return reference.inverse() * estimate;
}

}  // namespace

Statistics statistics_of(std::vector<double> errors) {
  Statistics statistics;
  statistics.count = errors.size();
  if (errors.empty()) {
    return statistics;
  }
  const double n = static_cast<double>(errors.size());
  std::sort(errors.begin(), errors.end());
  statistics.min = errors.front();
  statistics.max = errors.back();
  const std::size_t middle = errors.size() / 2;
  statistics.median = errors.size() % 2 == 1 ? errors[middle] : 0.5 * (errors[middle - 1] + errors[middle]);
  statistics.mean = std::accumulate(errors.begin(), errors.end(), 0.0) / n;
  for (const double error : errors) {
    statistics.sse += error * error;
    statistics.std += (error - statistics.mean) * (error - statistics.mean) / n;
  }
  statistics.std = std::sqrt(statistics.std);
  statistics.rmse = std::sqrt(statistics.sse / n);
  return statistics;
}

std::vector<double> ape_translation_m(std::span<const PosePair> pairs, const Similarity& similarity) {
  std::vector<double> errors;
  for (const PosePair& pair : pairs) {
    errors.push_back((similarity.apply(pair.estimate).translation() - pair.reference.translation()).norm());
  }
  return errors;
}

std::vector<double> ape_rotation_rad(std::span<const PosePair> pairs, const Similarity& similarity) {
  std::vector<double> errors;
  for (const PosePair& pair : pairs) {
    errors.push_back(geometry::angle_between(pair.reference.rotation(), similarity.apply(pair.estimate).rotation()));
  }
  return errors;
}

std::vector<double> ape_full(std::span<const PosePair> pairs, const Similarity& similarity) {
  std::vector<double> errors;
  for (const PosePair& pair : pairs) {
    const Se3 E = pair.reference.inverse() * similarity.apply(pair.estimate);
    errors.push_back(std::hypot((E.rotation() - Eigen::Matrix3d::Identity()).norm(), E.translation().norm()));
  }
  return errors;
}

std::vector<IndexPair> select_pairs(std::span<const PosePair> pairs, const PairRule& rule) {
  switch (rule.unit) {
    case DeltaUnit::kFrames: return by_frames(pairs.size(), static_cast<std::size_t>(rule.delta), rule.all_pairs);
    case DeltaUnit::kMetres: return by_metres(pairs, rule);
    case DeltaUnit::kRadians: return by_angle(pairs, rule);
  }
  return {};
}

RelativeErrors rpe(std::span<const PosePair> pairs, std::span<const IndexPair> indices) {
  RelativeErrors errors;
  for (const IndexPair& index : indices) {
    const Se3 E = relative_error(pairs[index.first], pairs[index.second]);
    errors.translation_m.push_back(E.translation().norm());
    errors.rotation_rad.push_back(geometry::angle_between(Eigen::Matrix3d::Identity(), E.rotation()));
  }
  return errors;
}

std::vector<double> rpe_distance_m(std::span<const PosePair> pairs, std::span<const IndexPair> indices) {
  std::vector<double> errors;
  for (const IndexPair& index : indices) {
    const PosePair& a = pairs[index.first];
    const PosePair& b = pairs[index.second];
    const double reference = (b.reference.translation() - a.reference.translation()).norm();
    const double estimate = (b.estimate.translation() - a.estimate.translation()).norm();
    errors.push_back(std::abs(reference - estimate));
  }
  return errors;
}

KittiErrors kitti_segments(std::span<const PosePair> pairs) {
  const std::vector<double> path = cumulative_path_m(pairs, true);
  KittiErrors errors;
  for (std::size_t first = 0; first < pairs.size(); first += 10) {
    for (double length = 100.0; length <= 800.0; length += 100.0) {
      const auto last = std::upper_bound(path.begin() + static_cast<std::ptrdiff_t>(first), path.end(), path[first] + length);
      if (last == path.end()) {
        break;
      }
      const Se3 E = relative_error(pairs[first], pairs[static_cast<std::size_t>(last - path.begin())]);
      errors.translation += E.translation().norm() / length;
      const double cosine = std::clamp(0.5 * (E.rotation().trace() - 1.0), -1.0, 1.0);
      errors.rotation_radpm += std::acos(cosine) / length;
      ++errors.segments;
    }
  }
  if (errors.segments > 0) {
    errors.translation /= static_cast<double>(errors.segments);
    errors.rotation_radpm /= static_cast<double>(errors.segments);
  }
  return errors;
}

std::vector<double> tilt_rad(std::span<const PosePair> pairs) {
  std::vector<double> errors;
  if (pairs.empty()) {
    return errors;
  }
  const Similarity similarity = align(pairs, Alignment::kYaw);
  for (const PosePair& pair : pairs) {
    // The body's view of "up" in both worlds.
    const Eigen::Vector3d up_reference = pair.reference.rotation().row(2).transpose();
    const Eigen::Vector3d up_estimate = similarity.apply(pair.estimate).rotation().row(2).transpose();
    errors.push_back(std::atan2(up_reference.cross(up_estimate).norm(), up_reference.dot(up_estimate)));
  }
  return errors;
}

double end_drift_m(std::span<const PosePair> pairs, const Similarity& similarity) {
  if (pairs.empty()) {
    return 0.0;
  }
  const auto error = [&](const PosePair& pair) {
    return Eigen::Vector3d(similarity.apply(pair.estimate).translation() - pair.reference.translation());
  };
  return (error(pairs.back()) - error(pairs.front())).norm();
}

}  // namespace slamd::evaluation
