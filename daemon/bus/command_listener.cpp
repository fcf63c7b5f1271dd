#include "daemon/bus/command_listener.hpp"

#include <algorithm>
#include <utility>

#include "daemon/bus/encoding.hpp"

namespace slamd::bus {

CommandListener::CommandListener(const std::string& url, const std::string& prefix)
    : CommandListener(std::make_shared<Connection>(url), prefix) {}

CommandListener::CommandListener(std::shared_ptr<Connection> connection, const std::string& prefix)
    : channels_(prefix), connection_(std::move(connection)) {
  connection_->subscribe(channels_.command, [this](std::span<const std::byte> message) { take(message); });
}

std::optional<Command> CommandListener::poll(Clock::time_point now) {
  now_ = now;
  taken_.reset();
  // A flood must not hold the caller: what is more than a burst waits in LCM's queue of 30, which drops the oldest.
  for (int i = 0; i < kBurst && !taken_ && connection_->wait(std::chrono::milliseconds(0)); ++i) {
  }
  return std::move(taken_);
}

void CommandListener::take(std::span<const std::byte> message) {
  std::optional<Command> command = decode_command(message);
  if (!command) {
    ++counters_.malformed;
    return;
  }
  if (!limit_.admits(now_)) {
    ++counters_.limited;
    return;
  }
  const auto same_id = [&command](const std::optional<Known>& known) { return known && known->id == command->id; };
  const auto known = std::find_if(known_.begin(), known_.end(), same_id);
  if (known != known_.end()) {
    ++counters_.repeated;
    if ((*known)->reply) {
      send(*(*known)->reply);
    }
    return;
  }
  known_[next_known_] = Known{.id = command->id, .reply = std::nullopt};
  next_known_ = (next_known_ + 1) % known_.size();
  const std::string fault = fault_of(*command);
  if (!fault.empty()) {
    ++counters_.refused;
    answer({.id = command->id, .ok = false, .text = fault});
    return;
  }
  ++counters_.accepted;
  taken_ = std::move(command);
}

void CommandListener::answer(const Reply& reply) {
  for (std::optional<Known>& known : known_) {
    if (known && known->id == reply.id) {
      known->reply = reply;
    }
  }
  send(reply);
}

void CommandListener::send(const Reply& reply) {
  std::array<std::byte, kLargestMessage_bytes> buffer;
  const std::size_t size = encode(reply, buffer);
  connection_->send(channels_.reply, {buffer.data(), size});
}

}  // namespace slamd::bus
