#include "drivers/gnss/gnss_stream.hpp"

#include <algorithm>

namespace slamd::gnss {

namespace {

constexpr Duration kDay = std::chrono::hours(24);

std::optional<Duration> time_of(const Rmc& rmc) { return rmc.time_of_day; }
std::optional<Duration> time_of(const Gga& gga) { return gga.time_of_day; }
std::optional<Duration> time_of(const Gst& gst) { return gst.time_of_day; }

std::optional<Duration> time_of(const NavPvt& pvt) {
  if ((pvt.valid & 2U) == 0 || pvt.hour > 23 || pvt.minute > 59 || pvt.second > 60) {
    return std::nullopt;
  }
  return Duration(std::chrono::hours(pvt.hour) + std::chrono::minutes(pvt.minute) + std::chrono::seconds(pvt.second)) +
         Duration(pvt.nano_ns);
}

template <std::size_t kCount>
void copy_counts(const std::array<Counter, kCount>& from, std::array<std::uint64_t, kCount>& to) {
  std::transform(from.begin(), from.end(), to.begin(), [](const Counter& counter) { return counter.value(); });
}

}  // namespace

const char* name_of(MessageResult result) {
  switch (result) {
    case MessageResult::kPart: return "part";
    case MessageResult::kOther: return "other";
    case MessageResult::kMalformed: return "malformed";
    case MessageResult::kNoTime: return "without_time";
    case MessageResult::kRepeated: return "repeated";
    case MessageResult::kLate: return "late";
  }
  return "?";
}

GnssCounters GnssStream::counters() const {
  GnssCounters counters;
  copy_counts(messages_, counters.messages);
  copy_counts(fixes_, counters.fixes);
  counters.stream = frames_.counters();
  return counters;
}

GnssStream::Part GnssStream::read_frame(std::span<const std::byte> frame) {
  if (GnssFrames::is_sentence(frame)) {
    return read_sentence({reinterpret_cast<const char*>(frame.data()), frame.size()});
  }
  if (GnssFrames::is_ubx(frame)) {
    const UbxMessage message = read_ubx(frame);
    // Without a payload it is the host's question.
    if (message.message_class == ubx::kNav && message.id == ubx::kNavPvt && !message.payload.empty()) {
      return read_part(kPvt, NavPvt::parse(message.payload), &FixEpoch::pvt);
    }
  }
  count(MessageResult::kOther);
  return {};
}

GnssStream::Part GnssStream::read_sentence(std::string_view sentence) {
  const std::string_view type = sentence_type(sentence);
  if (type == "RMC") {
    return read_part(kRmc, parse_rmc(sentence), &FixEpoch::rmc);
  }
  if (type == "GGA") {
    return read_part(kGga, parse_gga(sentence), &FixEpoch::gga);
  }
  if (type == "GST") {
    return read_part(kGst, parse_gst(sentence), &FixEpoch::gst);
  }
  count(nmea_checksum_holds(sentence) ? MessageResult::kOther : MessageResult::kMalformed);
  return {};
}

template <typename Message>
GnssStream::Part GnssStream::read_part(unsigned kind, const std::optional<Message>& message,
                                       std::optional<Message> FixEpoch::*member) {
  Part part;
  const std::optional<Duration> time_of_day = message ? time_of(*message) : std::nullopt;
  if (!time_of_day) {
    count(message ? MessageResult::kNoTime : MessageResult::kMalformed);
    return part;
  }
  part.kind = kind;
  part.time_of_day = *time_of_day;
  part.epoch.*member = message;
  return part;
}

bool GnssStream::is_same_moment(Duration a, Duration b) {
  const Duration apart = std::chrono::abs(a - b);
  return apart <= kSameMoment || kDay - apart <= kSameMoment;
}

void GnssStream::begin(Duration time_of_day, Stamp received) {
  time_ = time_of_day;
  received_ = received;
  is_open_ = true;
  seen_ = 0;
  epoch_ = {};
}

/// Adds a message to the moment in hand; false when its fix is out.
bool GnssStream::put(const Part& part) {
  if (!is_open_) {
    count((seen_ & part.kind) != 0 ? MessageResult::kRepeated : MessageResult::kLate);
    seen_ |= part.kind;
    expected_ |= part.kind;
    return false;
  }
  count(MessageResult::kPart);
  seen_ |= part.kind;
  const auto replace = [](auto& mine, const auto& other) { mine = other ? other : mine; };
  replace(epoch_.rmc, part.epoch.rmc);
  replace(epoch_.gga, part.epoch.gga);
  replace(epoch_.gst, part.epoch.gst);
  replace(epoch_.pvt, part.epoch.pvt);
  return true;
}

void GnssStream::finish_moment(sensor::GnssFix& fix) {
  fix.stamp = received_;
  fixes_[static_cast<std::size_t>(epoch_.merge(fix))].add();
  is_open_ = false;
  expected_ = seen_;
}

}  // namespace slamd::gnss
