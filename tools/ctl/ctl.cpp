#include "tools/ctl/ctl.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>

#include "daemon/bus/encoding.hpp"
#include "tools/cli/cli.hpp"

namespace slamd::ctl {

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kRepeatAfter{400};  // below what the daemon takes a second
constexpr std::chrono::milliseconds kWait{20};

}  // namespace

bus::Reply ask(bus::Connection& connection, const Options& options, const std::function<void()>& idle) {
  const bus::Channels channels(options.prefix);
  const std::string fault = bus::fault_of(options.command);
  std::array<std::byte, bus::kLargestMessage_bytes> buffer;
  const std::size_t size = bus::encode(options.command, buffer);
  if (!fault.empty() || size == 0) {
    throw cli::UsageError(fault.empty() ? "the arguments are too long" : fault);
  }
  // The handler outlives this call inside the connection, so it owns what it writes to.
  const auto reply = std::make_shared<std::optional<bus::Reply>>();
  connection.subscribe(channels.reply, [reply, id = options.command.id](std::span<const std::byte> message) {
    const auto heard = bus::decode_reply(message);
    if (heard && heard->id == id) {
      *reply = heard;
    }
  });
  const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options.timeout_s));
  auto next_attempt = Clock::now();
  while (!*reply && Clock::now() < end) {
    if (Clock::now() >= next_attempt) {
      connection.send(channels.command, {buffer.data(), size});
      next_attempt = Clock::now() + kRepeatAfter;
    }
    idle();
    connection.wait(kWait);
  }
  if (!*reply) {
    throw std::runtime_error("no answer on " + options.url + " prefix " + options.prefix +
                             ": is slamd running? multicast route?");
  }
  return **reply;
}

void drive(bus::Connection& connection, const std::string& prefix, const bus::VelocityCommand& command, double seconds,
           const std::function<void(std::chrono::milliseconds)>& idle) {
  constexpr std::chrono::milliseconds kBetween{100};
  const bus::Channels channels(prefix);
  const auto send = [&](bus::VelocityCommand now) {
    now.stamp = Stamp(std::chrono::duration_cast<Duration>(std::chrono::system_clock::now().time_since_epoch()));
    std::array<std::byte, bus::kLargestMessage_bytes> buffer;
    connection.send(channels.velocity_command, {buffer.data(), bus::encode(now, buffer)});
  };
  const auto count = static_cast<int>(seconds / std::chrono::duration<double>(kBetween).count() + 0.5);
  for (int i = 0; i < count; ++i) {
    send(command);
    idle(kBetween);
  }
  send({});
}

std::string printable(const std::string& text) {
  std::string result = text;
  std::replace_if(result.begin(), result.end(),
                  [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; }, ' ');
  return result;
}

}  // namespace slamd::ctl
