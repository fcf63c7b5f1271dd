#include "core/loop/retrieval.hpp"

#include <algorithm>

namespace slamd::loop {

Retrieval::Retrieval(const RetrievalConfig& config)
    : config_(config),
      keyframes_(config.capacity),
      descriptors_(config.capacity),
      near_(config.shortlist),
      candidates_(config.shortlist) {}

bool Retrieval::add(KeyframeNumber keyframe, const Descriptor& descriptor) {
  if (!keyframes_.try_push_back(keyframe)) {
    return false;
  }
  descriptors_[keyframes_.size() - 1] = descriptor;
  return true;
}

/// The last one takes its place.
void Retrieval::remove(KeyframeNumber keyframe) {
  const auto found = std::find(keyframes_.begin(), keyframes_.end(), keyframe);
  if (found == keyframes_.end()) {
    return;
  }
  const auto place = static_cast<std::size_t>(found - keyframes_.begin());
  *found = keyframes_.back();
  descriptors_[place] = descriptors_[keyframes_.size() - 1];
  keyframes_.resize(keyframes_.size() - 1);
}

const Descriptor* Retrieval::find(KeyframeNumber keyframe) const {
  const auto found = std::find(keyframes_.begin(), keyframes_.end(), keyframe);
  return found == keyframes_.end() ? nullptr : &descriptors_[static_cast<std::size_t>(found - keyframes_.begin())];
}

/// Keeps the nearest in falling order of similarity; of two that are equal the earlier keyframe first.
void Retrieval::shortlist(const Descriptor& query, KeyframeNumber end) {
  near_.clear();
  const auto before = [&](const Near& a, const Near& b) {
    return a.similarity != b.similarity ? a.similarity > b.similarity : keyframes_[a.place] < keyframes_[b.place];
  };
  for (std::size_t place = 0; place < keyframes_.size(); ++place) {
    if (keyframes_[place] >= end) {
      continue;
    }
    const Near near{similarity(query, descriptors_[place]), place};
    if (near_.full() && (near_.empty() || !before(near, near_.back()))) {
      continue;
    }
    if (near_.full()) {
      near_.back() = near;
    } else {
      near_.push_back(near);
    }
    for (std::size_t i = near_.size() - 1; i > 0 && before(near_[i], near_[i - 1]); --i) {
      std::swap(near_[i], near_[i - 1]);
    }
  }
}

std::span<const Candidate> Retrieval::search(LoopNet& net, const Descriptor& query, KeyframeNumber end) {
  shortlist(query, end);
  candidates_.clear();
  for (const Near& near : near_) {
    const Comparison pair = net.compare(descriptors_[near.place], query);
    if (pair.overlap_logit > config_.least_overlap_logit) {
      candidates_.push_back({keyframes_[near.place], pair.overlap_logit, pair.yaw_rad, pair.yaw_margin});
    }
  }
  std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& a, const Candidate& b) {
    return a.overlap_logit != b.overlap_logit ? a.overlap_logit > b.overlap_logit : a.keyframe < b.keyframe;
  });
  return candidates_.view().first(std::min(candidates_.size(), config_.best));
}

}  // namespace slamd::loop
