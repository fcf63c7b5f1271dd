#include "core/occupancy/mirror.hpp"

namespace slamd::occupancy {

Mirror::Verdict Mirror::apply(const MapDelta& message) {
  if (message.map_id <= 0 || !is_well_formed(message)) {
    return Verdict::kMalformed;
  }
  if (message.map_id < map_id_) {
    return Verdict::kOlderMap;
  }
  const bool is_new = message.map_id != map_id_ || message.window.size != map_.window().size || message.cell_m != map_.cell_m();
  if (is_new) {
    begin(message);
  }
  if (message.newest >= newest_) {
    missing_.add({newest_, message.newest});
    newest_ = message.newest;
    stamp_ = message.stamp;
    follow(message.window);
  }
  missing_.remove(message.covers);
  BlockReader reader(message);
  while (const auto block = reader.next()) {
    put(*block, message.submap);
  }
  if (complete() && message.newest == newest_ && message.digest != digest_) {
    lose_all();
    return Verdict::kDiffers;
  }
  return is_new ? Verdict::kNewMap : Verdict::kTaken;
}

void Mirror::begin(const MapDelta& message) {
  map_id_ = message.map_id;
  epoch_ = message.epoch;
  newest_ = 0;
  map_ = StateMap(message.window, message.cell_m);
  lose_all();
}

void Mirror::forget() {
  map_id_ = 0;
  newest_ = 0;
  map_ = StateMap();
  lose_all();
}

void Mirror::lose_all() {
  map_.clear();
  numbers_.assign(map_.size(), 0);
  submaps_.assign(map_.size(), -1);
  digest_ = 0;
  missing_.clear();
  missing_.add({0, newest_});
}

void Mirror::follow(const Window& window) {
  map_.move_to(window.first, [this](std::size_t slot, const BlockIndex& old) {
    if (!map_.block(slot).all_unknown()) {
      left_.push_back({map_id_, submaps_[slot], old, map_.block(slot)});
      digest_ -= map_.block(slot).digest(old);
    }
    numbers_[slot] = 0;
    submaps_[slot] = -1;
  });
}

void Mirror::put(const SentBlock& block, std::int32_t submap) {
  const Window& window = map_.window();
  if (!window.contains(block.index)) {
    return;  // it was left behind since
  }
  const std::size_t slot = window.slot_of(block.index);
  if (block.number <= numbers_[slot]) {
    return;
  }
  digest_ += block.states.digest(block.index) - map_.block(slot).digest(block.index);
  map_.block(slot) = block.states;
  numbers_[slot] = block.number;
  submaps_[slot] = submap;
}

MapRequest Mirror::request() const {
  MapRequest request;
  request.map_id = map_id_;
  for (const NumberRange& range : missing_.view()) {
    if (!request.ranges.try_push_back(range)) {
      break;
    }
  }
  return request;
}

}  // namespace slamd::occupancy
