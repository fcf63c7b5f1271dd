#include "daemon/stages/gnss_stage.hpp"

namespace slamd::stages {

using sensor::GnssFix;

void GnssStage::add(std::span<const std::byte> bytes, Stamp received) {
  if (bytes.empty()) {
    return;
  }
  state_.last_bytes = received;
  stream_.add(bytes, received, [this](const GnssFix& fix) { add_fix(fix); });
  note_messages(received);
}

void GnssStage::add_sentence(std::string_view sentence, Stamp received) {
  if (sentence.empty()) {
    return;
  }
  state_.last_bytes = received;
  stream_.add_sentence(sentence, received, [this](const GnssFix& fix) { add_fix(fix); });
  note_messages(received);
}

void GnssStage::add_fix(const GnssFix& fix) {
  state_.newest = fix;
  ++state_.fixes;
  if (!fix.is_good()) {
    return;
  }
  state_.first_good = state_.good == 0 ? fix.stamp : state_.first_good;
  ++state_.good;
  state_.last_good = fix.stamp;
  if (fix.utc) {
    state_.first_utc = state_.first_utc ? state_.first_utc : fix.utc;
    state_.last_utc = fix.utc;
  }
  if (const auto p_enu = frame_.enu_of(fix)) {
    state_.p_enu_antenna_m = {p_enu->x(), p_enu->y(), p_enu->z()};
  }
  state_.origin = frame_.origin();
}

void GnssStage::finish(Stamp received) {
  stream_.finish(received, [this](const GnssFix& fix) { add_fix(fix); });
}

/// A message of any kind tells that the receiver is there, and at which rate.
void GnssStage::note_messages(Stamp received) {
  const gnss::GnssCounters counters = stream_.counters();
  std::uint64_t good = 0;
  for (const std::uint64_t count : counters.messages) {
    good += count;
  }
  const std::uint64_t malformed = counters.of(gnss::MessageResult::kMalformed);
  if (good - malformed != messages_) {
    messages_ = good - malformed;
    state_.last_message = received;
  }
  state_.damaged = malformed + counters.stream.damaged;
}

std::vector<std::pair<std::string, std::uint64_t>> GnssStage::counts() const {
  std::vector<std::pair<std::string, std::uint64_t>> counts;
  stream_.each_count([&](const char* name, std::uint64_t count) {
    if (counts.empty() || count != 0) {
      counts.emplace_back(name, count);
    }
  });
  return counts;
}

}  // namespace slamd::stages
