#include "core/sensor/imu_buffer.hpp"

#include <algorithm>

#include "core/base/assert.hpp"

namespace slamd::sensor {

std::string_view to_string(ImuRefusal reason) {
  switch (reason) {
    case ImuRefusal::kDuplicate:
      return "duplicate";
    case ImuRefusal::kOutOfOrder:
      return "out_of_order";
    case ImuRefusal::kNotFinite:
      return "not_finite";
    case ImuRefusal::kImplausible:
      return "implausible";
    case ImuRefusal::kFarAhead:
      return "far_ahead";
  }
  return "unknown";
}

ImuBuffer::ImuBuffer(const ImuBufferConfig& config) : config_(config), ring_(2 * config.capacity) {
  SLAMD_ASSERT(config.capacity > 0);
}

bool ImuBuffer::push(const ImuSample& sample) {
  auto reason = refusal(sample);
  if (!reason) {
    reason = disorder(sample.stamp);
  }
  if (reason) {
    ++counts_.refused[static_cast<std::size_t>(*reason)];
    return false;
  }
  const std::size_t capacity = config_.capacity;
  if (size_ == capacity) {
    begin_ = (begin_ + 1) % capacity;
    --size_;
    ++counts_.overwritten;
  }
  const std::size_t slot = (begin_ + size_) % capacity;
  ring_[slot] = sample;
  ring_[slot + capacity] = sample;
  ++size_;
  ++counts_.accepted;
  return true;
}

std::optional<ImuRefusal> ImuBuffer::refusal(const ImuSample& sample) const {
  if (!sample.angular_rate_radps.allFinite() || !sample.specific_force_mps2.allFinite()) {
    return ImuRefusal::kNotFinite;
  }
  if (sample.angular_rate_radps.cwiseAbs().maxCoeff() > config_.max_angular_rate_radps ||
      sample.specific_force_mps2.cwiseAbs().maxCoeff() > config_.max_specific_force_mps2) {
    return ImuRefusal::kImplausible;
  }
  return std::nullopt;
}

std::optional<ImuRefusal> ImuBuffer::disorder(Stamp stamp) {
  switch (gate_.judge(stamp)) {
    case StampVerdict::kInOrder:
      return std::nullopt;
    case StampVerdict::kAhead:
      return ImuRefusal::kFarAhead;
    case StampVerdict::kOld:
      return !empty() && stamp == newest().stamp ? ImuRefusal::kDuplicate : ImuRefusal::kOutOfOrder;
    case StampVerdict::kSteppedBack:
      begin_ = size_ = 0;
      ++counts_.restarts;
      return std::nullopt;
  }
  return std::nullopt;
}

const ImuSample& ImuBuffer::oldest() const {
  SLAMD_ASSERT(!empty());
  return ring_[begin_];
}

const ImuSample& ImuBuffer::newest() const {
  SLAMD_ASSERT(!empty());
  return ring_[begin_ + size_ - 1];
}

std::span<const ImuSample> ImuBuffer::between(Stamp t0, Stamp t1) const {
  const auto all = samples();
  const auto first = std::ranges::upper_bound(all, t0, {}, &ImuSample::stamp);
  const auto last = std::ranges::upper_bound(first, all.end(), t1, {}, &ImuSample::stamp);
  return {first, last};
}

bool ImuBuffer::covers(Stamp t) const {
  return !empty() && oldest().stamp <= t && t <= newest().stamp;
}

std::optional<ImuSample> ImuBuffer::at(Stamp t) const {
  if (!covers(t)) {
    return std::nullopt;
  }
  const auto all = samples();
  const auto after = std::ranges::lower_bound(all, t, {}, &ImuSample::stamp);
  if (after->stamp == t) {
    return *after;
  }
  const auto before = after - 1;
  const double share = to_seconds(t - before->stamp) / to_seconds(after->stamp - before->stamp);
  ImuSample sample;
  sample.stamp = t;
  sample.angular_rate_radps =
      before->angular_rate_radps + share * (after->angular_rate_radps - before->angular_rate_radps);
  sample.specific_force_mps2 = before->specific_force_mps2 +
                               share * (after->specific_force_mps2 - before->specific_force_mps2);
  return sample;
}

void ImuBuffer::drop_before(Stamp t) {
  const auto all = samples();
  const auto after = std::ranges::upper_bound(all, t, {}, &ImuSample::stamp);
  const auto older = static_cast<std::size_t>(after - all.begin());
  if (older < 2) {
    return;
  }
  begin_ = (begin_ + older - 1) % config_.capacity;
  size_ -= older - 1;
}

}  // namespace slamd::sensor
