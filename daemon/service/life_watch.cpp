#include "daemon/service/life_watch.hpp"

#include <algorithm>

namespace slamd::service {

void LifeWatch::look(const std::vector<Pulse>& pulses, const Flow& flow, Stamp now) {
  fault_.clear();
  rounds_.resize(pulses.size());
  for (std::size_t i = 0; i < pulses.size(); ++i) {
    rounds_[i].see(pulses[i].rounds, now);
    if (now - rounds_[i].at > (pulses[i].may_block ? kBlockingPatience : kThreadPatience)) {
      fault_ += (fault_.empty() ? "" : ", ") + pulses[i].thread + " hangs";
    }
  }
  if (poses_are_stale(flow, now)) {
    fault_ += std::string(fault_.empty() ? "" : ", ") + "input flows, but no pose comes";
  }
}

bool LifeWatch::poses_are_stale(const Flow& flow, Stamp now) {
  const bool first = inputs_.at == Stamp{};
  const Stamp input_before = inputs_.at;
  inputs_.see(flow.inputs, now);
  poses_.see(flow.poses, now);
  if (first || now - inputs_.at > kPause || inputs_.at - input_before > kPause ||
      !flow.poses_expected) {
    flows_since_ = now;
  }
  return now - std::max(flows_since_, poses_.at) > kPosePatience;
}

}  // namespace slamd::service
