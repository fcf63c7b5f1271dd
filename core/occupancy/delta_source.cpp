#include "core/occupancy/delta_source.hpp"

#include <algorithm>

namespace slamd::occupancy {

void DeltaSource::restart(std::int64_t map_id, std::uint32_t epoch) {
  head_ = {};
  head_.map_id = map_id;
  head_.epoch = epoch;
  told_ = key_ = 0;
  wanted_.clear();
  anchors_ = {};
}

void DeltaSource::set_anchor(std::int32_t submap, const BlockIndex& anchor) {
  anchors_[static_cast<std::size_t>(submap) % kAnchors] = {submap, anchor};
}

const DeltaSource::Anchor* DeltaSource::anchor_of(std::int32_t submap) const {
  if (submap < 0) {
    return nullptr;
  }
  const Anchor& anchor = anchors_[static_cast<std::size_t>(submap) % kAnchors];
  return anchor.submap == submap ? &anchor : nullptr;
}

void DeltaSource::request(const MapRequest& request) {
  if (request.map_id != head_.map_id) {
    return;  // of a map that is gone: the next message tells
  }
  for (const NumberRange& range : request.ranges) {
    wanted_.add({range.from, std::min(range.to, told_)});
  }
}

void DeltaSource::begin(Stamp stamp) {
  head_.stamp = stamp;
  head_.newest = grid_.changes().newest();
  head_.digest = grid_.digest();
  head_.cell_m = grid_.states().cell_m();
  head_.window = grid_.states().window();
  change_left_ = true;
  keys_left_ = config_.key_messages;
  repairs_left_ = config_.repair_messages;
}

bool DeltaSource::next(MapDelta& message, DeltaKind& kind) {
  if (change_left_) {
    kind = DeltaKind::kChange;
    fill(message, told_, head_.newest);
    told_ = message.covers.to;
    change_left_ = told_ < head_.newest;
    return true;
  }
  if (keys_left_ > 0) {
    --keys_left_;
    kind = DeltaKind::kKey;
    fill(message, key_, head_.newest);
    if (message.covers.to == head_.newest) {  // round: no further in this update, which would tell twice
      key_ = 0;
      keys_left_ = 0;
    } else {
      key_ = message.covers.to;
    }
    return true;
  }
  if (repairs_left_ > 0 && !wanted_.empty()) {
    --repairs_left_;
    kind = DeltaKind::kRepair;
    const NumberRange wanted = wanted_.view().front();
    fill(message, wanted.from, wanted.to);
    wanted_.remove({wanted.from, message.covers.to});
    return true;
  }
  return false;
}

/// Tells what has changed last at `from` < number ≤ `to`, as far as there is room and all are of one submap.
void DeltaSource::fill(MapDelta& message, std::uint64_t from, std::uint64_t to) {
  message = head_;
  message.covers = {from, to};
  BlockWriter writer(message);
  const StateMap& states = grid_.states();
  bool first = true;
  std::uint64_t last = from;
  for (const std::uint32_t slot : grid_.changes().after(from)) {
    const std::uint64_t number = grid_.changes().number(slot);
    if (number > to) {
      break;
    }
    const Anchor* anchor = anchor_of(grid_.submap(slot));
    const std::int32_t submap = anchor != nullptr ? anchor->submap : -1;
    if (first) {
      message.submap = submap;
      message.anchor = anchor != nullptr ? anchor->anchor : BlockIndex{};
      first = false;
    }
    if (submap != message.submap || !writer.add({number, states.window().block_at(slot), states.block(slot)})) {
      message.covers.to = last;
      return;
    }
    last = number;
  }
}

}  // namespace slamd::occupancy
