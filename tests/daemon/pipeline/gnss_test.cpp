#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <span>
#include <string>

#include <gtest/gtest.h>

#include "core/base/assert.hpp"
#include "daemon/pipeline/gnss_loop.hpp"
#include "daemon/pipeline/health_monitor.hpp"
#include "drivers/gnss/nmea.hpp"
#include "tests/scratch/scratch_folder.hpp"

namespace slamd::pipeline {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using stages::GnssState;
using threads::Event;

/// A receiver's end of a pseudo terminal, which a link leads to.
class Receiver {
 public:
  explicit Receiver(fs::path link) : link_(std::move(link)) {
    char name[64];
    fd_ = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
    SLAMD_ASSERT(fd_ >= 0 && grantpt(fd_) == 0 && unlockpt(fd_) == 0 && ptsname_r(fd_, name, sizeof name) == 0);
    fs::create_symlink(name, link_);
  }
  ~Receiver() {
    fs::remove(link_);
    close(fd_);
  }
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;

  void say(const std::string& text) { EXPECT_EQ(::write(fd_, text.data(), text.size()), static_cast<ssize_t>(text.size())); }

  /// Says where it is in the i-th second of some hour.
  void say_second(int i, char status = 'A') {
    char body[120];
    std::snprintf(body, sizeof body, "GNRMC,10%02d%02d.00,%c,4807.038,N,01131.000,E,1.0,90.0,230326,,,A", i / 60, i % 60, status);
    say(gnss::framed(body));
  }

 private:
  fs::path link_;
  int fd_ = -1;
};

class GnssAtASerialPort : public scratch::ScratchFolder {
 protected:
  GnssAtASerialPort() {
    configuration_.gnss.source = "serial";
    configuration_.gnss.device = link_.string();
    configuration_.gnss.baud = 9600;
  }

  /// Lets the loop run until something holds, at most for ten seconds.
  template <typename Holds>
  bool runs_until(GnssLoop& sut, Holds&& holds) {
    for (const auto begin = std::chrono::steady_clock::now(); std::chrono::steady_clock::now() - begin < 10s;) {
      sut.run_once(10ms);
      if (holds()) {
        return true;
      }
    }
    return false;
  }

  bool hears(GnssLoop& sut, Event event) {
    return runs_until(sut, [&] {
      const auto record = sut.events().try_read();
      value_ = record ? record->value : 0;
      return record && record->event == event;
    });
  }

  std::uint64_t value_ = 0;  // of the event that was heard

  fs::path link_ = folder_ / "gnss";  // made by the receiver
  transport::HostClock clock_;
  configuration::Configuration configuration_;
};

TEST_F(GnssAtASerialPort, ReadsFixesAndTellsWhenTheyAreLost) {
  Receiver receiver(link_);
  GnssLoop sut(configuration_, clock_);
  ASSERT_TRUE(hears(sut, Event::kSerialOpen));

  for (int i = 0; i < 3; ++i) {
    receiver.say_second(i);
  }
  EXPECT_TRUE(hears(sut, Event::kGnssFix));
  EXPECT_TRUE(runs_until(sut, [&] { return sut.state().good == 3; }));
  receiver.say_second(3, 'V');
  receiver.say_second(4, 'V');
  EXPECT_TRUE(hears(sut, Event::kGnssNoFix));
  EXPECT_TRUE(runs_until(sut, [&] { return sut.state().fixes == 5; }));

  const GnssState state = sut.state();
  EXPECT_EQ(state.good, 3U);
  EXPECT_EQ(state.fixes, 5U);
  EXPECT_FALSE(state.has_fix());
  EXPECT_NEAR(to_seconds(clock_.now() - state.last_bytes), 0.0, 5.0);
}

TEST_F(GnssAtASerialPort, ComesBackWhenItWasUnplugged) {
  GnssLoop sut(configuration_, clock_);
  ASSERT_TRUE(hears(sut, Event::kSerialRefused));  // not there yet
  {
    Receiver receiver(link_);
    ASSERT_TRUE(hears(sut, Event::kSerialOpen));
    receiver.say_second(0);
    receiver.say_second(1);
    ASSERT_TRUE(hears(sut, Event::kGnssFix));
  }
  ASSERT_TRUE(hears(sut, Event::kSerialLost));
  const std::uint64_t before = sut.state().good;

  Receiver receiver(link_);
  ASSERT_TRUE(hears(sut, Event::kSerialOpen));
  receiver.say_second(9);
  receiver.say_second(10);

  EXPECT_TRUE(runs_until(sut, [&] { return sut.state().good > before; }));
}

TEST_F(GnssAtASerialPort, FindsItsRateByListening) {
  configuration_.gnss.baud = 0;
  Receiver receiver(link_);
  GnssLoop sut(configuration_, clock_);
  ASSERT_TRUE(hears(sut, Event::kSerialOpen));

  receiver.say_second(0);
  receiver.say_second(1);

  EXPECT_TRUE(hears(sut, Event::kGnssFound));  // a pseudo terminal is good at any rate
  EXPECT_EQ(value_, static_cast<std::uint64_t>(transport::BaudHunt::kRates[0]));
}

TEST_F(GnssAtASerialPort, GoesOnToTheNextRateWhileNothingIsReadable) {
  configuration_.gnss.baud = 0;
  Receiver receiver(link_);
  GnssLoop sut(configuration_, clock_);
  ASSERT_TRUE(hears(sut, Event::kSerialOpen));
  const auto begin = std::chrono::steady_clock::now();
  receiver.say("noise of another rate");

  runs_until(sut, [&] { return std::chrono::steady_clock::now() - begin > GnssLoop::kDwell + 200ms; });
  receiver.say_second(0);
  receiver.say_second(1);

  EXPECT_TRUE(hears(sut, Event::kGnssFound));
  EXPECT_EQ(value_, static_cast<std::uint64_t>(transport::BaudHunt::kRates[1]));
}

TEST(GnssCause, SaysWhatIsMissing) {
  const Stamp now{1000s};
  GnssState state;

  EXPECT_EQ(gnss_cause(state, now), "gnss: no GNSS bytes yet");
  state.last_bytes = now - 1s;
  EXPECT_EQ(gnss_cause(state, now), "gnss: bytes arrive, but neither NMEA nor UBX: another rate?");
  state.last_message = now - 1s;
  state.newest.satellites = 3;
  EXPECT_EQ(gnss_cause(state, now), "gnss: no fix yet, 3 satellites");
  state.last_good = now - 1s;
  EXPECT_EQ(gnss_cause(state, now), "");
  state.last_good = now - 12'300ms;
  EXPECT_EQ(gnss_cause(state, now), "gnss: no fix for 12.3 s, 3 satellites");
  state.last_bytes = now - 4s;
  EXPECT_EQ(gnss_cause(state, now), "gnss: no GNSS bytes for 4.0 s");
}

}  // namespace
}  // namespace slamd::pipeline
