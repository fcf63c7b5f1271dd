#include "tools/sensors/network_watch.hpp"

#include <algorithm>

#include "drivers/livox/sdk1_frame.hpp"

namespace slamd::sensors {

using livox::FrameResult;

namespace {

constexpr std::byte kStartOfFrame{0xAA};
constexpr std::size_t kVersionAt = 1;
constexpr std::byte kSdk1Version{1};

}  // namespace

NetworkWatch::NetworkWatch() : scratch_(std::make_unique<sensor::PointBlock>()) {
  for (const LidarProtocol protocol : {LidarProtocol::kVelodyne, LidarProtocol::kSdk1, LidarProtocol::kSdk2}) {
    probes_.push_back(std::make_unique<LidarWatch>(protocol, 0));
  }
}

bool NetworkWatch::take(const Arrival& arrival, std::span<const transport::Interface> own) {
  if (arrival.payload.size() > kVersionAt && arrival.payload[0] == kStartOfFrame) {
    const bool is_sdk1 = arrival.payload[kVersionAt] == kSdk1Version;
    if (is_sdk1 ? take_sdk1_frames(arrival) : take_sdk2_frames(arrival, own)) {
      return true;
    }
  }
  return take_data(arrival);
}

bool NetworkWatch::take_sdk1_frames(const Arrival& arrival) {
  std::span<const std::byte> rest = arrival.payload;
  livox::Sdk1Frame frame;
  std::size_t size = 0;
  bool understood = false;
  while (!rest.empty() && parse_sdk1_frame(rest, frame, size) == FrameResult::kOk) {
    if (frame.command == livox::Sdk1Command::kBroadcast && frame.type == livox::Sdk1FrameType::kMessage) {
      if (const auto broadcast = livox::Sdk1Broadcast::parse(frame.payload)) {
        understood = true;
        if (LidarWatch* const lidar = watch(LidarProtocol::kSdk1, arrival.source)) {
          lidar->take(*broadcast, arrival.received);
        }
      }
    }
    rest = rest.subspan(size);
  }
  return understood;
}

bool NetworkWatch::take_sdk2_frames(const Arrival& arrival, std::span<const transport::Interface> own) {
  std::span<const std::byte> rest = arrival.payload;
  livox::Sdk2Frame frame;
  std::size_t size = 0;
  bool understood = false;
  while (!rest.empty() && parse_sdk2_frame(rest, frame, size) == FrameResult::kOk) {
    understood = take_sdk2_frame(frame, arrival, own) || understood;
    rest = rest.subspan(size);
  }
  return understood;
}

bool NetworkWatch::take_sdk2_frame(const livox::Sdk2Frame& frame, const Arrival& arrival,
                                   std::span<const transport::Interface> own) {
  if (!frame.from_device) {
    if (frame.command == livox::Sdk2Command::kDiscovery && !frame.ack) {
      note_searcher(arrival.source, own);
      return true;
    }
    return false;
  }
  if (frame.command == livox::Sdk2Command::kDiscovery && frame.ack) {
    const auto answer = livox::Sdk2Discovery::parse(frame.payload);
    if (!answer || answer->result != 0) {
      return false;
    }
    if (LidarWatch* const lidar = watch(LidarProtocol::kSdk2, arrival.source)) {
      lidar->take(*answer, arrival.received);
    }
    return true;
  }
  const bool is_answer = frame.command == livox::Sdk2Command::kGetParameters && frame.ack;
  if (!is_answer && (frame.command != livox::Sdk2Command::kStatePush || frame.ack)) {
    return false;
  }
  if (LidarWatch* const lidar = watch(LidarProtocol::kSdk2, arrival.source)) {
    lidar->take(is_answer ? livox::Sdk2ValueReader::of_answer(frame.payload) : livox::Sdk2ValueReader::of_push(frame.payload));
  }
  return true;
}

bool NetworkWatch::take_data(const Arrival& arrival) {
  LidarWatch* sender = nullptr;
  for (const auto& lidar : lidars_) {
    if (lidar->address() == arrival.source) {
      if (lidar->take_data(arrival, *scratch_)) {
        return true;
      }
      sender = lidar.get();
    }
  }
  for (const auto& probe : probes_) {
    if (probe->take_data(arrival, *scratch_)) {
      if (LidarWatch* const lidar = watch(probe->protocol(), arrival.source)) {
        lidar->take_data(arrival, *scratch_);
      }
      return true;
    }
  }
  if (take_rows(arrival)) {
    return true;
  }
  if (sender != nullptr) {
    sender->refuse();
  }
  return false;
}

bool NetworkWatch::take_rows(const Arrival& arrival) {
  const auto known = std::find_if(rows_.begin(), rows_.end(), [&](const auto& rows) {
    return rows->address == arrival.source && rows->port == arrival.port;
  });
  RowsWatch* rows = known == rows_.end() ? nullptr : known->get();
  if (rows == nullptr) {
    bool has_sample = false;
    imu::CsvRows{}.add_datagram(arrival.payload, arrival.received, [&](const sensor::ImuReading&) { has_sample = true; });
    if (!has_sample) {
      return false;
    }
    if (rows_.size() >= kMostSensors) {
      ++left_out_;
      return true;
    }
    rows = rows_.emplace_back(std::make_unique<RowsWatch>()).get();
    rows->address = arrival.source;
    rows->port = arrival.port;
  }
  bool has_sample = false;
  rows->decoder.add_datagram(arrival.payload, arrival.received, [&](const sensor::ImuReading& reading) {
    has_sample = true;
    rows->samples.add(reading);
  });
  return has_sample;
}

LidarWatch* NetworkWatch::watch(LidarProtocol protocol, std::uint32_t address) {
  for (const auto& lidar : lidars_) {
    if (lidar->protocol() == protocol && lidar->address() == address) {
      return lidar.get();
    }
  }
  if (lidars_.size() >= kMostSensors) {
    ++left_out_;
    return nullptr;
  }
  return lidars_.emplace_back(std::make_unique<LidarWatch>(protocol, address)).get();
}

void NetworkWatch::note_searcher(std::uint32_t address, std::span<const transport::Interface> own) {
  const bool is_own = std::any_of(own.begin(), own.end(), [&](const transport::Interface& interface) { return interface.address == address; });
  const bool is_known = std::find(searchers_.begin(), searchers_.end(), address) != searchers_.end();
  if (!is_own && !is_known && searchers_.size() < kMostSensors) {
    searchers_.push_back(address);
  }
}

void NetworkWatch::end_second() {
  for (const auto& lidar : lidars_) {
    lidar->end_second();
  }
  for (const auto& rows : rows_) {
    rows->samples.end_second();
  }
}

std::vector<livox::Endpoint> NetworkWatch::sdk2_devices() const {
  std::vector<livox::Endpoint> devices;
  for (const auto& lidar : lidars_) {
    if (lidar->commands().port != 0) {
      devices.push_back(lidar->commands());
    }
  }
  return devices;
}

void NetworkWatch::show(Stamp now, Seen& seen) const {
  for (const auto& lidar : lidars_) {
    const bool is_there = std::any_of(seen.lidars.begin(), seen.lidars.end(), [&](const LidarSeen& other) {
      return other.protocol == lidar->protocol() && other.address == lidar->address();
    });
    if (!is_there) {
      seen.lidars.push_back(lidar->seen(now));
    }
  }
  for (const auto& rows : rows_) {
    RowsSeen& shown = seen.rows.emplace_back(RowsSeen{rows->address, rows->port, rows->samples.seen()});
    const imu::RowCounters counters = rows->decoder.counters();
    for (std::size_t i = 1; i < imu::kRowResults; ++i) {
      shown.imu.refused += counters.rows[i];
    }
  }
  seen.searchers.insert(seen.searchers.end(), searchers_.begin(), searchers_.end());
  seen.left_out += left_out_;
}

}  // namespace slamd::sensors
