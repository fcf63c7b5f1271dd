// Keeps a copy of a daemon's map for some seconds and prints, as JSON, how that went. Everything it needs is slamd::client's.
//   map_watch URL PREFIX SECONDS [listen]      listen: never asks
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include "client/map_client.hpp"

int main(int argc, char** argv) {
  using Clock = std::chrono::steady_clock;
  if (argc < 4) {
    std::fprintf(stderr, "map_watch URL PREFIX SECONDS [listen]\n");
    return 2;
  }
  slamd::client::MapClientConfig config;
  config.url = argv[1];
  config.prefix = argv[2];
  config.asks = argc < 5 || std::string(argv[4]) != "listen";
  const double seconds = std::atof(argv[3]);
  slamd::client::MapClient client(config);
  std::size_t left = 0;
  const auto begin = Clock::now();
  const auto elapsed_s = [&begin] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
  double heard_s = -1.0;
  double complete_s = -1.0;
  double longest_gap_s = 0.0;
  double whole_s = 0.0;  // when it was complete last
  while (elapsed_s() < seconds) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const auto view = client.view();
    const double now_s = elapsed_s();
    heard_s = view->known() && heard_s < 0.0 ? now_s : heard_s;
    complete_s = view->complete() && complete_s < 0.0 ? now_s : complete_s;
    longest_gap_s = complete_s >= 0.0 && !view->complete() ? std::max(longest_gap_s, now_s - whole_s) : longest_gap_s;
    whole_s = view->complete() ? now_s : whole_s;
    client.take_left([&left](const auto&) { ++left; });
  }
  const double incomplete_s = complete_s >= 0.0 ? elapsed_s() - whole_s : seconds;
  // The drive may go on: an update under way has this long to come whole.
  while (!client.view()->complete() && elapsed_s() < seconds + 2.0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    client.take_left([&left](const auto&) { ++left; });
  }
  const auto counts = client.counts();
  const auto view = client.view();
  std::size_t occupied = 0;
  std::size_t free = 0;
  for (std::size_t slot = 0; slot < view->cells().size(); ++slot) {
    for (int z = 0; z < 8; ++z) {
      occupied += static_cast<std::size_t>(__builtin_popcountll(view->cells().block(slot).occupied[static_cast<std::size_t>(z)]));
      free += static_cast<std::size_t>(__builtin_popcountll(view->cells().block(slot).free[static_cast<std::size_t>(z)]));
    }
  }
  std::printf("{\"complete\":%s,\"complete_after_s\":%.3f,\"longest_gap_s\":%.3f,\"incomplete_s\":%.3f,\"bytes_per_s\":%.0f,\"messages\":%llu,\"requests\":%llu,"
              "\"maps\":%llu,\"malformed\":%llu,\"differs\":%llu,\"occupied\":%zu,\"free\":%zu,\"left\":%zu,\"submaps\":%zu}\n",
              view->complete() ? "true" : "false", complete_s < 0.0 ? -1.0 : complete_s - heard_s, longest_gap_s, incomplete_s,
              heard_s < 0.0 ? 0.0 : static_cast<double>(counts.bytes) / (elapsed_s() - heard_s), static_cast<unsigned long long>(counts.messages),
              static_cast<unsigned long long>(counts.requests), static_cast<unsigned long long>(counts.maps),
              static_cast<unsigned long long>(counts.malformed), static_cast<unsigned long long>(counts.differs), occupied, free, left,
              view->submaps().size());
  return 0;
}
