#include "drivers/storage/session_keeper.hpp"

#include <algorithm>
#include <ctime>
#include <stdexcept>
#include <tuple>

namespace slamd::storage {

namespace fs = std::filesystem;

namespace {

constexpr Duration kSyncPeriod = std::chrono::seconds(1);
constexpr Duration kRetryPeriod = std::chrono::seconds(10);
constexpr std::size_t kNameLength = 16;  // of the time; a second session of one second has "-2" behind it
constexpr std::uint64_t kNextToNothing_bytes = 64'000;  // two or three keyframes

/// Calls visit(entry) for what is in a folder, as far as that can be read. Does not throw, as the iterator's ++ does.
template <typename Visit>
void for_each_in(const fs::path& folder, Visit&& visit) {
  std::error_code error;
  for (fs::directory_iterator entry(folder, error); !error && entry != fs::directory_iterator(); entry.increment(error)) {
    visit(*entry);
  }
}

/// Takes a session's files away, and its folder if nothing else is in it.
void remove_session(const fs::path& folder) {
  std::vector<fs::path> files;
  for_each_in(folder, [&](const fs::directory_entry& entry) {
    if (is_segment_name(entry.path())) {
      files.push_back(entry.path());
    }
  });
  std::error_code error;
  for (const fs::path& file : files) {
    fs::remove(file, error);
  }
  fs::remove(folder, error);
}

}  // namespace

std::string session_name(Stamp begun) {
  const std::time_t seconds = std::chrono::duration_cast<std::chrono::seconds>(begun.time_since_epoch()).count();
  std::tm utc{};
  ::gmtime_r(&seconds, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y%m%dT%H%M%SZ", &utc);
  return text;
}

bool is_session_name(const fs::path& folder) {
  const std::string name = folder.filename().string();
  if (name.size() < kNameLength || name[8] != 'T' || name[15] != 'Z' || (name.size() > kNameLength && name[kNameLength] != '-')) {
    return false;
  }
  for (std::size_t i = 0; i < name.size(); ++i) {
    if (i != 8 && i != 15 && i != kNameLength && (name[i] < '0' || name[i] > '9')) {
      return false;
    }
  }
  return name.size() != kNameLength + 1;
}

SessionLimits limits_of(const SessionKeeping& keeping) {
  SessionLimits limits{.quota_bytes = keeping.quota_bytes};
  if (keeping.quota_bytes > 0) {  // only files that are done can go: the one that is written is a small part of all
    limits.segment_bytes = std::clamp(keeping.quota_bytes / 8, std::min(keeping.least_segment_bytes, limits.segment_bytes), limits.segment_bytes);
  }
  return limits;
}

SessionKeeper::SessionKeeper(SessionKeeping keeping) : keeping_(std::move(keeping)) {}

void SessionKeeper::note(const mapping::Mapper& mapper, const mapping::MapperUpdate& update, Stamp now) {
  if (!is_on()) {
    return;
  }
  if (recorder_) {
    recorder_->note(mapper, update);
    if (!recorder_->writer().fault().empty()) {
      last_try_ = fault_.empty() ? now : last_try_;
      fault_ = recorder_->writer().fault();
      lacks_ = true;
    }
  } else if (update.keyframe_added) {
    lacks_ = true;
  }
  attend(mapper, now);
}

void SessionKeeper::attend(const mapping::Mapper& mapper, Stamp now) {
  if (!is_on()) {
    return;
  }
  if (lacks_ && (fault_.empty() || now - last_try_ >= kRetryPeriod)) {
    last_try_ = now;
    if (recorder_ ? recorder_->writer().retry() : begin(now)) {
      recorder_->catch_up(mapper);
      fault_ = recorder_->writer().fault();
      lacks_ = !fault_.empty();
    } else if (recorder_) {
      fault_ = recorder_->writer().fault();
    }
  }
  if (recorder_ && now - last_sync_ >= kSyncPeriod) {
    last_sync_ = now;
    if (fault_.empty()) {
      recorder_->writer().sync();
    }
    make_room();
  }
}

void SessionKeeper::close() {
  if (recorder_) {
    recorder_->close();
  }
  recorder_.reset();
  session_.clear();
  fault_.clear();
  lacks_ = false;
}

bool SessionKeeper::begin(Stamp now) {
  look_for_others();
  const std::string name = session_name(now);
  fs::path folder = keeping_.folder / name;
  std::error_code error;
  for (int again = 2; fs::exists(folder, error); ++again) {
    folder = keeping_.folder / (name + "-" + std::to_string(again));
  }
  while (!others_.empty() && others_.size() + 1 > keeping_.sessions) {
    remove_first();
  }
  try {
    const auto number = static_cast<std::uint64_t>(now.time_since_epoch().count());
    recorder_.emplace(folder, SessionBegin{number, 0, keeping_.sensor, keeping_.software}, limits_of(keeping_));
  } catch (const std::exception& failure) {
    fault_ = failure.what();
    fs::remove(folder, error);  // if nothing is in it
    return false;
  }
  session_ = folder;
  begun_ = now;
  fault_.clear();
  return true;
}

void SessionKeeper::look_for_others() {
  others_.clear();
  for_each_in(keeping_.folder, [&](const fs::directory_entry& entry) {
    std::error_code error;
    if (entry.is_directory(error) && !entry.is_symlink(error) && is_session_name(entry.path())) {
      others_.push_back(look_at(entry.path()));
    }
  });
  const auto rank = [](const Other& other) {
    return std::tuple(other.bytes >= kNextToNothing_bytes, other.written, other.folder.native().size(), other.folder.native());
  };
  std::sort(others_.begin(), others_.end(), [&](const Other& a, const Other& b) { return rank(a) < rank(b); });
}

SessionKeeper::Other SessionKeeper::look_at(const fs::path& folder) {
  Other other{folder, 0, fs::file_time_type::min()};
  for_each_in(folder, [&](const fs::directory_entry& entry) {
    if (!is_segment_name(entry.path())) {
      return;
    }
    std::error_code error;
    if (const std::uintmax_t bytes = entry.file_size(error); !error) {
      other.bytes += bytes;
    }
    if (const fs::file_time_type written = entry.last_write_time(error); !error) {
      other.written = std::max(other.written, written);
    }
  });
  return other;
}

void SessionKeeper::make_room() {
  const auto all = [&] {
    std::uint64_t bytes = recorder_->writer().bytes();
    for (const Other& other : others_) {
      bytes += other.bytes;
    }
    return bytes;
  };
  while (keeping_.quota_bytes > 0 && !others_.empty() && all() > keeping_.quota_bytes) {
    remove_first();
  }
}

void SessionKeeper::remove_first() {
  remove_session(others_.front().folder);
  others_.erase(others_.begin());
  ++removed_;
}

}  // namespace slamd::storage
