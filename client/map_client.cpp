#include "client/map_client.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <span>
#include <thread>
#include <vector>

#include "client/submap_table.hpp"
#include "core/base/latest.hpp"
#include "core/base/spsc_queue.hpp"
#include "daemon/bus/channels.hpp"
#include "daemon/bus/connection.hpp"
#include "daemon/bus/encoding.hpp"
#include "daemon/bus/map_encoding.hpp"

namespace slamd::client {

using occupancy::Mirror;
using Clock = std::chrono::steady_clock;

namespace {

/// What is missing may just be late; then it is asked for, and again where no answer comes.
constexpr auto kPatience = std::chrono::milliseconds(30);
constexpr auto kAskAgain = std::chrono::milliseconds(250);
/// A daemon whose clock was behind when it started again numbers its map lower than the one before, and a forged message may
/// have told of changes that there were none of: what is behind is believed when nothing else has come for so long.
constexpr auto kGone = std::chrono::seconds(1);
constexpr std::chrono::milliseconds kLongestSleep{20};
constexpr int kQueue = 500;
/// So many messages at most before what has come is shown.
constexpr int kBatch = 200;

}  // namespace

class MapClient::Work {
 public:
  explicit Work(const MapClientConfig& config)
      : channels_(config.prefix), asks_(config.asks), connection_(config.url), left_(config.left_blocks) {
    const auto map = [this](std::span<const std::byte> message) { take_map(message); };
    connection_.subscribe(channels_.map_delta, map, kQueue);
    connection_.subscribe(channels_.map_snapshot, map, kQueue);
    connection_.subscribe(channels_.map_to_odom, [this](std::span<const std::byte> message) {
      if (const auto told = bus::decode_map_to_odom(message)) {
        T_map_odom_ = isometry_of(told->T_map_odom);
        news_ = true;
      }
    });
    connection_.subscribe(channels_.submap_poses, [this](std::span<const std::byte> message) {
      if (const auto told = bus::decode_submap_poses(message)) {
        news_ = submaps_.add(*told) || news_;
      }
    });
    if (config.own_thread) {
      thread_ = std::thread([this] {
        while (!stopping_.load(std::memory_order_relaxed)) {
          connection_.wait(kLongestSleep);
          handle();
        }
      });
    }
  }

  ~Work() {
    stopping_.store(true, std::memory_order_relaxed);
    if (thread_.joinable()) {
      thread_.join();
    }
  }

  void handle() {
    for (int i = 0; i < kBatch && connection_.wait(std::chrono::milliseconds(0)); ++i) {
    }
    ask(Clock::now());
    show();
    counts_shown_.store(counts_);
  }

  int fd() const { return connection_.fd(); }
  View view() const { return views_.read(); }
  MapClientCounts counts() const { return counts_shown_.load().value_or(MapClientCounts{}); }

  void take_left(const std::function<void(const Mirror::LeftBlock&)>& visit) {
    while (const auto block = left_.try_pop()) {
      visit(*block);
    }
  }

 private:
  void take_map(std::span<const std::byte> message) {
    ++counts_.messages;
    counts_.bytes += message.size();
    const auto delta = bus::decode_map_delta(message);
    if (!delta) {
      ++counts_.malformed;
      return;
    }
    const Clock::time_point now = Clock::now();
    const bool same_odom = mirror_.known() && mirror_.epoch() == delta->epoch;
    const std::uint64_t newest = mirror_.newest();
    Mirror::Verdict verdict = mirror_.apply(*delta);
    bool is_behind = verdict == Mirror::Verdict::kOlderMap || (verdict == Mirror::Verdict::kTaken && delta->newest < newest);
    if (is_behind && now - heard_ > kGone) {
      mirror_.forget();
      verdict = mirror_.apply(*delta);
      is_behind = false;
    }
    if (verdict == Mirror::Verdict::kMalformed) {
      ++counts_.malformed;
      return;
    }
    if (verdict == Mirror::Verdict::kOlderMap) {
      ++counts_.older;
      return;
    }
    if (verdict == Mirror::Verdict::kNewMap) {
      ++counts_.maps;
      ++copy_;
      if (same_odom) {
        submaps_ = SubmapTable{};  // of a daemon that has started again, perhaps, whose stamps may be lower
      }
    }
    if (verdict == Mirror::Verdict::kDiffers) {
      ++counts_.differs;
      ++copy_;
    }
    heard_ = is_behind ? heard_ : now;
    news_ = true;
    mirror_.take_left([this](const Mirror::LeftBlock& block) { counts_.left_lost += left_.try_push(block) ? 0 : 1; });
  }

  void ask(Clock::time_point now) {
    if (!mirror_.known() || mirror_.complete()) {
      missing_since_ = {};
      return;
    }
    if (missing_since_ == Clock::time_point{}) {
      missing_since_ = now;
    }
    if (asks_ && now - missing_since_ >= kPatience && now - asked_ >= kAskAgain) {
      asked_ = now;
      std::array<std::byte, bus::kLargestMessage_bytes> buffer;
      const std::size_t size = bus::encode(mirror_.request(), buffer);
      counts_.requests += connection_.send(channels_.map_request, {buffer.data(), size}) ? 1 : 0;
    }
  }

  /// Copies what has changed into a view that nobody looks at, and shows it.
  void show() {
    if (!news_) {
      return;
    }
    MapView* view = views_.begin();
    if (view == nullptr) {
      ++counts_.views_late;
      return;
    }
    news_ = false;
    const occupancy::StateMap& map = mirror_.map();
    if (view->copy_ != copy_) {
      view->copy_ = copy_;
      view->map_ = map;
      view->numbers_.assign(map.size(), 0);
      view->block_submaps_.assign(map.size(), -1);
    }
    view->map_.move_to(map.window().first, [](std::size_t, const occupancy::BlockIndex&) {});
    for (std::size_t slot = 0; slot < map.size(); ++slot) {
      if (view->numbers_[slot] != mirror_.number(slot) || mirror_.number(slot) == 0) {
        view->map_.block(slot) = map.block(slot);
        view->numbers_[slot] = mirror_.number(slot);
        view->block_submaps_[slot] = mirror_.submap(slot);
      }
    }
    view->map_id_ = mirror_.map_id();
    view->complete_ = mirror_.complete();
    view->stamp_ = mirror_.stamp();
    view->current_from_ = mirror_.missing().empty() ? 0 : mirror_.missing().back().to;
    view->T_map_odom_ = T_map_odom_;
    view->submaps_ = submaps_.epoch() == mirror_.epoch() ? submaps_.places() : std::vector<SubmapPlace>{};
    views_.publish();
  }

  bus::Channels channels_;
  bool asks_;
  Mirror mirror_;
  SubmapTable submaps_;
  Eigen::Isometry3d T_map_odom_ = Eigen::Isometry3d::Identity();
  std::uint64_t copy_ = 0;  // which one mirror_ is making; a number of a change says nothing about another's blocks
  bool news_ = false;
  Clock::time_point heard_{};
  Clock::time_point missing_since_{};
  Clock::time_point asked_{};
  MapClientCounts counts_;
  Latest<MapClientCounts> counts_shown_;  // written by the receiving thread, read by the caller's
  ViewExchange<MapView> views_;           // likewise
  bus::Connection connection_;
  SpscQueue<Mirror::LeftBlock> left_;  // from the receiving thread to take_left()'s
  std::atomic<bool> stopping_{false};  // written by the destructor, read by the thread
  std::thread thread_;                 // last: it works on all of the above
};

MapClient::MapClient(const MapClientConfig& config) : work_(std::make_unique<Work>(config)) {}
MapClient::~MapClient() = default;

MapClient::View MapClient::view() const { return work_->view(); }
MapClientCounts MapClient::counts() const { return work_->counts(); }
void MapClient::take_left(const std::function<void(const Mirror::LeftBlock&)>& visit) { work_->take_left(visit); }
int MapClient::fd() const { return work_->fd(); }
void MapClient::handle() { work_->handle(); }

}  // namespace slamd::client
