#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

struct _lcm_t;

namespace slamd::bus {

/// The bus cannot be reached: what LCM was given and what to look at, in words.
class BusError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One connection to LCM.
/// Errors: the constructor and subscribe() throw BusError.
/// Threads: send() from any; the others, and the destructor, from one.
class Connection {
 public:
  using Handler = std::function<void(std::span<const std::byte> message)>;

  explicit Connection(const std::string& url);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Calls handler, from wait(), with each message of exactly this channel. So many of them LCM keeps while nobody waits.
  void subscribe(const std::string& channel, Handler handler, int queue = 30);

  /// Sends one message. Real-time: no allocation on udpm.
  bool send(const std::string& channel, std::span<const std::byte> message);

  /// Waits until a message comes, handles it, and returns whether one came. Zero: does not wait.
  bool wait(std::chrono::milliseconds timeout);

  /// Becomes readable when wait() has something to do.
  int fd() const;

  const std::string& url() const { return url_; }

 private:
  std::string url_;
  _lcm_t* lcm_ = nullptr;
  std::vector<std::unique_ptr<Handler>> handlers_;
};

}  // namespace slamd::bus
