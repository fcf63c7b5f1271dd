#include "drivers/transport/baud_hunt.hpp"

#include <algorithm>

namespace slamd::transport {

void BaudHunt::begin(Stamp now) {
  tried_ = 0;
  frames_ = 0;
  probed_ = false;
  found_ = false;
  probe_at_ = now + kProbeAfter;
  until_ = now + dwell_;
}

void BaudHunt::hear(Stamp now) {
  found_ = ++frames_ >= kFrames;
  until_ = std::max(until_, now + dwell_);  // a slow sensor may take as long again
}

bool BaudHunt::advance(Stamp now) {
  if (found_ || now < until_) {
    return false;
  }
  rate_ = (rate_ + 1) % kRates.size();
  ++tried_;
  frames_ = 0;
  probed_ = false;
  probe_at_ = now + kProbeAfter;
  until_ = now + dwell_;
  return true;
}

bool BaudHunt::take_probe(Stamp now) {
  if (found_ || probed_ || frames_ > 0 || now < probe_at_) {
    return false;
  }
  probed_ = true;
  return true;
}

}  // namespace slamd::transport
