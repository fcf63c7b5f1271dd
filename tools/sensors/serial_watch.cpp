#include "tools/sensors/serial_watch.hpp"

#include <array>
#include <optional>

#include "drivers/gnss/gnss_stream.hpp"
#include "drivers/imu/csv_rows.hpp"
#include "drivers/imu/mip.hpp"
#include "drivers/imu/xsens.hpp"
#include "tools/sensors/inertial_watch.hpp"

namespace slamd::sensors {

namespace {

constexpr std::array<Tongue, 4> kTongues{Tongue::kXsens, Tongue::kMip, Tongue::kCsv, Tongue::kGnss};

}  // namespace

/// All that listens at one rate; begun anew with the next.
struct SerialWatch::Readers {
  imu::XsensReader xsens{std::chrono::milliseconds(10)};  // a device without SampleTimeFine is heard all the same
  imu::MipReader mip;
  imu::CsvRows rows;
  transport::ByteFrames<gnss::GnssFrames> frames;
  gnss::GnssStream fixes;
  InertialWatch inertial;
  SecondCount sentences;
  SecondCount ubx;
  SecondCount told;
  SecondCount good;
  sensor::GnssFix last_fix;
  std::array<std::uint64_t, 4> heard{};  // good frames by tongue, as kTongues has them

  void take_gnss(std::span<const std::byte> bytes, Stamp now) {
    frames.add(bytes, [&](std::span<const std::byte> frame) {
      sentences.add(gnss::GnssFrames::is_sentence(frame) ? 1 : 0);
      ubx.add(gnss::GnssFrames::is_ubx(frame) ? 1 : 0);
    });
    fixes.add(bytes, now, [&](const sensor::GnssFix& fix) {
      told.add();
      good.add(fix.is_good() ? 1 : 0);
      last_fix = fix;
    });
  }

  void end_second() {
    inertial.end_second();
    for (SecondCount* count : {&sentences, &ubx, &told, &good}) {
      count->end_second();
    }
  }

  /// Good frames, by tongue.
  std::array<std::uint64_t, 4> good_frames() const {
    return {xsens.stream().frames, mip.stream().frames, rows.counters().of(imu::RowResult::kOk), frames.counters().frames};
  }

  /// Why the last fix was not good: the verdict that is counted most, but for the good ones.
  std::string lacks() const {
    const gnss::GnssCounters counters = fixes.counters();
    std::size_t most = 0;
    for (std::size_t i = 1; i < gnss::kFixVerdicts; ++i) {
      most = counters.fixes[i] > (most == 0 ? 0 : counters.fixes[most]) ? i : most;
    }
    return most == 0 || last_fix.is_good() ? "" : gnss::name_of(static_cast<gnss::FixVerdict>(most));
  }
};

SerialWatch::SerialWatch(Stamp now) : readers_(std::make_unique<Readers>()) { hunt_.begin(now); }

SerialWatch::~SerialWatch() = default;

void SerialWatch::begin(Stamp now) {
  forget();
  hunt_.begin(now);
}

void SerialWatch::forget() {
  readers_ = std::make_unique<Readers>();
  tongue_ = Tongue::kNone;
  asked_ = false;
}

int SerialWatch::baud() const { return hunt_.baud(); }

void SerialWatch::take(std::span<const std::byte> bytes, Stamp now) {
  bytes_.add(bytes.size());
  Readers& readers = *readers_;
  const auto sample = [&](const sensor::ImuReading& reading) { readers.inertial.add(reading); };
  if (tongue_ == Tongue::kNone || tongue_ == Tongue::kXsens) {
    readers.xsens.add(bytes, now, sample);
  }
  if (tongue_ == Tongue::kNone || tongue_ == Tongue::kMip) {
    readers.mip.add(bytes, now, sample);
  }
  if (tongue_ == Tongue::kNone || tongue_ == Tongue::kCsv) {
    readers.rows.add_stream(bytes, now, sample);
  }
  if (tongue_ == Tongue::kNone || tongue_ == Tongue::kGnss) {
    readers.take_gnss(bytes, now);
  }
  judge(now);
}

void SerialWatch::judge(Stamp now) {
  const std::array<std::uint64_t, 4> frames = readers_->good_frames();
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (frames[i] == readers_->heard[i]) {
      continue;
    }
    const bool is_answer = asked_ && (kTongues[i] == Tongue::kXsens || kTongues[i] == Tongue::kMip);
    if (tongue_ == Tongue::kNone && (is_answer || frames[i] >= static_cast<std::uint64_t>(transport::BaudHunt::kFrames))) {
      hunt_.hear_answer();
      tongue_ = kTongues[i];
    }
    hunt_.hear(now);  // a slow sensor gets as long again for its second frame
    heard_ = now;
  }
  readers_->heard = frames;
}

bool SerialWatch::advance(Stamp now) {
  if (tongue_ != Tongue::kNone) {
    if (now - heard_ < kForgetAfter || answers_alone()) {
      return false;
    }
    begin(now);
  }
  if (!hunt_.advance(now)) {
    return false;
  }
  forget();
  return true;
}

FixedVector<std::byte, 64> SerialWatch::take_question(Stamp now) {
  FixedVector<std::byte, 64> question;
  if (tongue_ != Tongue::kNone || !hunt_.take_probe(now)) {
    return question;
  }
  asked_ = true;
  const std::byte ping[] = {std::byte{2}, std::byte{imu::mip::kPing}};
  const imu::XbusBytes xbus = imu::write_xbus({imu::xbus::kGoToMeasurement, {}});
  const imu::MipBytes mip = imu::write_mip({imu::mip::kBaseCommands, ping});
  for (const std::span<const std::byte> bytes : {xbus.view(), mip.view()}) {
    for (const std::byte byte : bytes) {
      question.push_back(byte);
    }
  }
  return question;
}

bool SerialWatch::answers_alone() const {
  return asked_ && tongue_ != Tongue::kNone && readers_->inertial.seen().samples.total == 0;
}

void SerialWatch::end_second() {
  bytes_.end_second();
  readers_->end_second();
}

LineSeen SerialWatch::seen() const {
  const Readers& readers = *readers_;
  LineSeen seen;
  seen.baud = hunt_.baud();
  seen.found = tongue_ != Tongue::kNone;
  seen.tongue = tongue_;
  seen.answers = answers_alone();
  seen.rounds = hunt_.rounds();
  seen.bytes = bytes_.count();
  if (tongue_ == Tongue::kGnss) {
    seen.gnss = {readers.sentences.count(), readers.ubx.count(), readers.told.count(), readers.good.count(), readers.lacks(),
                 readers.last_fix.satellites, static_cast<unsigned>(readers.last_fix.quality)};
    return seen;
  }
  switch (tongue_) {
    case Tongue::kXsens: seen.imu = readers.inertial.seen(readers.xsens.counters()); break;
    case Tongue::kMip: seen.imu = readers.inertial.seen(readers.mip.counters()); break;
    case Tongue::kCsv: {
      seen.imu = readers.inertial.seen();
      const imu::RowCounters rows = readers.rows.counters();
      for (std::size_t i = 1; i < imu::kRowResults; ++i) {
        seen.imu.refused += rows.rows[i];
      }
      break;
    }
    default: break;
  }
  return seen;
}

}  // namespace slamd::sensors
