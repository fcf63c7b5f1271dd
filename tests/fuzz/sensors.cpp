// Any bytes as what the sensors of a robot send to slamd-sensors: datagrams, with and without good checksums, bytes of a serial
// line, CAN frames, an Avia's answers. Whatever came, what is said of it must be text that can be shown, and the configuration
// that is written from it one that slamd takes.
#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/base/assert.hpp"
#include "daemon/configuration/loader.hpp"
#include "drivers/livox/sdk1_frame.hpp"
#include "drivers/livox/sdk2_frame.hpp"
#include "tools/sensors/avia_question.hpp"
#include "tools/sensors/can_watch.hpp"
#include "tools/sensors/json.hpp"
#include "tools/sensors/network_watch.hpp"
#include "tools/sensors/remarks.hpp"
#include "tools/sensors/serial_watch.hpp"
#include "tools/sensors/starting_configuration.hpp"
#include "tools/sensors/table.hpp"

namespace {

using namespace slamd;
using namespace slamd::sensors;

const std::vector<transport::Interface> kInterfaces{{1, 0x7F000001, 0xFF000000, false}, {2, 0x0A4D0001, 0xFFFFFF00, true}};
constexpr std::uint32_t kSources[] = {0x0A4D0002, 0x0A4D0001, 0xC0A80164};  // a sensor, this host, another subnet's
constexpr std::uint16_t kPorts[] = {2368, 8308, 55000, 56000, 56001, 56201, 56301, 56401, 7501, 65000};
constexpr Stamp kBegin{std::chrono::seconds{1'700'000'000}};

/// The input, from its front.
class Bytes {
 public:
  explicit Bytes(std::span<const std::byte> bytes) : rest_(bytes) {}

  bool empty() const { return rest_.empty(); }
  unsigned number() { return rest_.empty() ? 0 : std::to_integer<unsigned>(taken(1)[0]); }
  std::span<const std::byte> taken(std::size_t size) {
    const auto front = rest_.first(std::min(size, rest_.size()));
    rest_ = rest_.subspan(front.size());
    return front;
  }

 private:
  std::span<const std::byte> rest_;
};

class Robot {
 public:
  void play(Bytes bytes) {
    while (!bytes.empty()) {
      step(bytes);
    }
  }

  void check() const {
    const Seen seen = this->seen();
    const std::vector<Remark> remarks = remarks_of(seen, std::nullopt);
    check_text(draw(seen, remarks, {}));
    check_text(second_as_lines(seen));
    check_text(remarks_as_lines(remarks));
    SLAMD_ASSERT(nlohmann::json::accept(to_json(seen, remarks)));
    if (std::any_of(seen.lidars.begin(), seen.lidars.end(), [](const LidarSeen& lidar) { return lidar.model.has_value(); })) {
      configuration::Loader loader;
      loader.add_text(starting_configuration(seen, "2026-11-28 12:00 UTC"), "written.toml");
      loader.load();  // throws where a key, a unit or a range is wrong
    }
  }

 private:
  void step(Bytes& bytes) {
    const unsigned what = bytes.number();
    switch (what % 8) {
      case 0: return datagram(bytes.taken(1 + 6 * bytes.number()), what, bytes);
      case 1: return sdk1(bytes, what);
      case 2: return sdk2(bytes, what);
      case 3:
        serial_.take(bytes.taken(1 + bytes.number()), now_);
        return;
      case 4: return frame(bytes, what);
      case 5: {
        const livox::FrameBytes release = avia_.take(bytes.taken(bytes.number()));
        SLAMD_ASSERT(release.empty() || avia_.answer() == AviaAnswer::kConsent);
        return;
      }
      case 6:
        serial_.take_question(now_);
        return;
      default: return pass(bytes.number());
    }
  }

  void datagram(std::span<const std::byte> payload, unsigned what, Bytes& bytes) {
    const Arrival arrival{payload, kSources[(what / 8) % std::size(kSources)], kPorts[bytes.number() % std::size(kPorts)], now_};
    network_.take(arrival, kInterfaces);
  }

  void sdk1(Bytes& bytes, unsigned what) {
    const unsigned command = bytes.number();
    const livox::Sdk1Frame frame{static_cast<livox::Sdk1FrameType>(what / 8 % 3), 7,
                                 static_cast<livox::Sdk1Command>(command / 128 * 256 + command % 16), bytes.taken(bytes.number() % 64)};
    datagram(livox::write_sdk1_frame(frame).view(), what, bytes);
  }

  void sdk2(Bytes& bytes, unsigned what) {
    const unsigned command = bytes.number();
    const livox::Sdk2Frame frame{7, static_cast<livox::Sdk2Command>(command / 64 * 256 + command % 8), (what & 64U) != 0,
                                 (what & 128U) != 0, bytes.taken(bytes.number() % 200)};
    datagram(livox::write_sdk2_frame(frame).view(), what, bytes);
  }

  void frame(Bytes& bytes, unsigned what) {
    transport::CanFrame frame{.id = bytes.number() << 16U | bytes.number() << 8U | bytes.number(), .is_extended = (what & 8U) != 0,
                              .size = 0, .data = {}, .received = now_};
    const auto data = bytes.taken(bytes.number() % 9);
    frame.size = static_cast<std::uint8_t>(data.size());
    std::copy(data.begin(), data.end(), frame.data.begin());
    can_.take(frame);
  }

  void pass(unsigned tens_of_ms) {
    now_ += std::chrono::milliseconds{10 * tens_of_ms};
    serial_.advance(now_);
    if (tens_of_ms > 50) {
      network_.end_second();
      serial_.end_second();
      can_.end_second();
    }
  }

  Seen seen() const {
    Seen seen;
    seen.listened_s = std::chrono::duration<double>(now_ - kBegin).count();
    seen.interfaces = kInterfaces;
    network_.show(now_, seen);
    seen.avias = {{avia_.address(), avia_.answer(), ""}};
    seen.lines = {serial_.seen()};
    seen.lines[0].device = "/dev/ttyUSB0";
    seen.buses = {can_.seen()};
    seen.buses[0].interface = "can0";
    return seen;
  }

  /// No byte of a sensor's reaches the terminal as a control character.
  static void check_text(const std::string& text) {
    for (std::size_t i = 0; i < text.size(); ++i) {
      const auto c = static_cast<unsigned char>(text[i]);
      SLAMD_ASSERT(c == '\n' || (c >= 0x20 && c != 0x7F));
      SLAMD_ASSERT(c != 0xC2 || (i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) >= 0xA0));  // C1, in UTF-8
    }
    static_cast<void>(nlohmann::json(text).dump());  // throws what ends the fuzzer where it is no UTF-8
  }

  Stamp now_ = kBegin;
  NetworkWatch network_;
  SerialWatch serial_{kBegin};
  CanWatch can_;
  AviaQuestion avia_{0xC0A80164};
};

}  // namespace

// The input is a script of what arrives, and of time that passes.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  Robot robot;
  robot.play(Bytes(std::as_bytes(std::span(bytes, size))));
  robot.check();
  return 0;
}
