#include "drivers/storage/session_writer.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <unistd.h>

namespace slamd::storage {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kDigits = 6;
constexpr const char* kExtension = ".slamd";
constexpr std::size_t kPosesARecord = 10'000;

}  // namespace

std::string segment_name(std::uint32_t segment) {
  std::string digits = std::to_string(segment);
  digits.insert(0, kDigits - std::min(kDigits, digits.size()), '0');
  return digits + kExtension;
}

bool is_segment_name(const fs::path& file) {
  const std::string stem = file.stem().string();
  return file.extension() == kExtension && stem.size() >= kDigits &&
         std::all_of(stem.begin(), stem.end(), [](char c) { return c >= '0' && c <= '9'; });
}

SessionWriter::SessionWriter(const fs::path& folder, const SessionBegin& begin, const SessionLimits& limits)
    : folder_(folder), begin_(begin), limits_(limits) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (!error) {
    for (fs::directory_iterator entry(folder_, error); !error && entry != fs::directory_iterator(); entry.increment(error)) {
      if (is_segment_name(entry->path()) && !fs::remove(entry->path(), error) && error) {
        break;
      }
    }
  }
  if (error) {
    throw std::runtime_error(folder_.string() + ": " + error.message());
  }
  if (!open_segment()) {
    throw std::runtime_error(fault_);
  }
}

SessionWriter::~SessionWriter() { close_segment(); }

bool SessionWriter::write(std::span<const SessionPose> poses) {
  bool written = true;
  while (!poses.empty()) {
    const std::size_t count = std::min(poses.size(), kPosesARecord);
    written = append(SessionRecord::kPoses, payload_of(poses.first(count))) && written;
    poses = poses.subspan(count);
  }
  return written;
}

void SessionWriter::sync() {
  if (fd_ >= 0 && ::fdatasync(fd_) != 0) {
    fail("cannot be brought to the disk");
  }
}

void SessionWriter::close() {
  append(SessionRecord::kEnd, {});
  sync();
  close_segment();
}

bool SessionWriter::retry() {
  if (!fault_.empty()) {
    close_segment();
    remove_empty_segment();
    fault_.clear();
    open_segment();
  }
  return fault_.empty();
}

bool SessionWriter::append(SessionRecord kind, const RecordBytes& payload) {
  bool written = false;
  if (fd_ >= 0 && fault_.empty() && payload.size() <= RecordFrame::kMaxPayload) {
    const std::size_t bytes = RecordFrame{kind, 0, payload}.bytes();
    if (segment_bytes_ + bytes > limits_.segment_bytes && segment_records_ > 1 && kind != SessionRecord::kEnd) {
      close_segment();
      if (fault_.empty()) {
        open_segment();
      }
    }
    written = fault_.empty() && append_bytes(framed({kind, next_number_, payload}));
  }
  ++next_number_;  // of what is dropped, too: a reader will miss it
  dropped_records_ += written ? 0 : 1;
  return written;
}

bool SessionWriter::append_bytes(const RecordBytes& bytes) {
  std::size_t written = 0;
  while (written < bytes.size()) {
    const ssize_t count = ::write(fd_, bytes.data() + written, bytes.size() - written);
    if (count < 0 && errno == EINTR) {
      continue;
    }
    if (count <= 0) {
      fail("cannot be written");
      if (::ftruncate(fd_, static_cast<off_t>(segment_bytes_)) != 0) {
        fault_ += ", nor cut back to its last whole record";
      }
      return false;
    }
    written += static_cast<std::size_t>(count);
  }
  segment_bytes_ += bytes.size();
  ++segment_records_;
  bytes_ += bytes.size();
  keep_quota();
  return true;
}

bool SessionWriter::open_segment() {
  const fs::path file = folder_ / segment_name(begin_.segment);
  fd_ = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_APPEND, 0644);
  if (fd_ < 0) {
    fail("cannot be made");
    return false;
  }
  segment_bytes_ = 0;
  segment_records_ = 0;
  const RecordBytes payload = payload_of(begin_);
  ++begin_.segment;
  if (append_bytes(framed({SessionRecord::kBegin, next_number_++, payload}))) {
    return true;
  }
  ::close(fd_);  // nothing of it is left behind: retry() may come here often
  fd_ = -1;
  --begin_.segment;
  --next_number_;
  std::error_code none;
  fs::remove(file, none);
  return false;
}

void SessionWriter::close_segment() {
  if (fd_ >= 0) {
    sync();
    if (::close(fd_) != 0 && fault_.empty()) {
      fail("cannot be closed");
    }
    fd_ = -1;
    closed_.push_back({folder_ / segment_name(begin_.segment - 1), segment_bytes_});
  }
}

/// Takes the last file away, which is closed, if it says nothing but that it begins.
void SessionWriter::remove_empty_segment() {
  if (segment_records_ != 1 || closed_.empty()) {
    return;
  }
  std::error_code error;
  if (fs::remove(closed_.back().file, error)) {
    bytes_ -= closed_.back().bytes;
    closed_.pop_back();
    --begin_.segment;
    --next_number_;  // the begin's: all that came after it was dropped, and a reader misses as many as that
    segment_records_ = 0;
  }
}

void SessionWriter::keep_quota() {
  while (limits_.quota_bytes > 0 && bytes_ > limits_.quota_bytes && !closed_.empty()) {
    std::error_code error;
    fs::remove(closed_.front().file, error);
    bytes_ -= closed_.front().bytes;
    closed_.pop_front();
    ++dropped_segments_;
  }
}

void SessionWriter::fail(const std::string& what) {
  const int error = errno;
  fault_ = (folder_ / segment_name(begin_.segment - (fd_ >= 0 && begin_.segment > 0 ? 1 : 0))).string() + ": " + what + ": " + std::strerror(error);
}

}  // namespace slamd::storage
