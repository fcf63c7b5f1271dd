#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "client/map_view.hpp"
#include "client/view_exchange.hpp"
#include "core/occupancy/mirror.hpp"

namespace slamd::client {

struct MapClientConfig {
  std::string url = "udpm://239.255.76.67:7667?ttl=0";
  std::string prefix = "SLAMD";
  bool own_thread = true;  // false: call handle() where fd() is readable, and ten times a second
  bool asks = true;        // false: only listens, and is whole again by key blocks
  std::size_t left_blocks = 4096;  // that wait for take_left()
};

/// What has come and what became of it.
struct MapClientCounts {
  std::uint64_t messages = 0;   // of the map
  std::uint64_t bytes = 0;      // of them, as LCM carries them
  std::uint64_t malformed = 0;
  std::uint64_t older = 0;      // of a map that is gone
  std::uint64_t maps = 0;       // that have begun
  std::uint64_t requests = 0;   // sent
  std::uint64_t differs = 0;    // times that the copy was found to be wrong, and fetched anew
  std::uint64_t left_lost = 0;  // blocks that nobody took
  std::uint64_t views_late = 0; // times that all views were being held
};

/// Keeps a copy of the map around the robot, and asks for what it has missed.
///
/// view() gives the newest whole copy, from any thread, and never waits: see ViewExchange. Hold a view as long as one plan
/// takes; the map goes on in others.
/// Errors: the constructor throws std::runtime_error where LCM cannot be reached, std::invalid_argument for a bad prefix.
/// Threads: view() and counts() by any; take_left() by one; handle() by one, where there is no thread of its own.
class MapClient {
 public:
  using View = ViewExchange<MapView>::Reader;

  explicit MapClient(const MapClientConfig& config = {});
  ~MapClient();
  MapClient(const MapClient&) = delete;
  MapClient& operator=(const MapClient&) = delete;

  /// The newest copy; before the first message one that is not known(). Ends before the client does.
  View view() const;

  MapClientCounts counts() const;

  /// Calls visit(LeftBlock) for each block that the window has left behind since the last call: what a map of everything is
  /// made of, each in its submap. MapView::submap() says where that lies now, so that nothing is fetched twice.
  void take_left(const std::function<void(const occupancy::Mirror::LeftBlock&)>& visit);

  /// Becomes readable when handle() has something to do.
  int fd() const;

  /// Takes what has come, without waiting, and asks for what is missing.
  void handle();

 private:
  class Work;  // what LCM needs, out of sight

  std::unique_ptr<Work> work_;
};

}  // namespace slamd::client
