#include "drivers/storage/session_reader.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <stdexcept>

#include "core/base/bytes.hpp"
#include "drivers/storage/session_writer.hpp"

namespace slamd::storage {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMostDamage = 100;  // that is named

std::vector<std::byte> bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  if (!stream) {
    throw std::runtime_error(file.string() + ": " + std::strerror(errno));
  }
  std::vector<std::byte> bytes(static_cast<std::size_t>(stream.tellg()));
  stream.seekg(0);
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (static_cast<std::size_t>(stream.gcount()) != bytes.size()) {
    throw std::runtime_error(file.string() + ": cannot be read");
  }
  return bytes;
}

const char* in_words(FrameVerdict verdict) {
  switch (verdict) {
    case FrameVerdict::kCut: return "cut off";
    case FrameVerdict::kDamaged: return "checksum";
    case FrameVerdict::kNewerFormat: return "of a newer format";
    case FrameVerdict::kNoRecord: break;
    case FrameVerdict::kGood: break;
  }
  return "no record";
}

/// Puts a session together from its records.
class Assembly {
 public:
  void begin_segment(const std::string& name) {
    segment_ = name;
    is_foreign_ = false;
  }

  /// Takes a record in; returns what is wrong with it.
  std::string take(const RecordFrame& frame) {
    if (is_foreign_) {
      return "belongs to another session";
    }
    try {
      read(frame);
    } catch (const SessionContentError& error) {
      return error.what();
    }
    count(frame.number);
    return "";
  }

  void damaged(std::uint64_t offset, std::uint64_t bytes, const std::string& what) {
    if (session_.damage.size() < kMostDamage) {
      session_.damage.push_back({segment_, offset, bytes, what});
    }
  }

  Session finish() {
    for (auto& [id, keyframe] : keyframes_) {
      const auto pose = poses_.find(id);
      session_.T_map_base.push_back(pose != poses_.end() ? pose->second : keyframe.T_odom_base);
      session_.keyframes.push_back(std::move(keyframe));
    }
    for (auto& [id, loop] : loops_) {
      if (keyframes_.contains(loop.a) && keyframes_.contains(loop.b)) {
        session_.loops.push_back(loop);
      }
    }
    return std::move(session_);
  }

  Session& session() { return session_; }
  bool has_begun() const { return has_begun_; }

 private:
  void read(const RecordFrame& frame) {
    switch (frame.kind) {
      case SessionRecord::kBegin: {
        const SessionBegin begin = read_begin(frame.payload);
        if (has_begun_ && begin.session != session_.begin.session) {
          is_foreign_ = true;  // and so does the rest of the file
          throw SessionContentError("belongs to another session");
        }
        if (!has_begun_) {
          session_.begin = begin;
          has_begun_ = true;
        }
        return;
      }
      case SessionRecord::kKeyframe: {
        SessionKeyframe keyframe = read_keyframe(frame.payload);
        keyframes_.insert_or_assign(keyframe.id, std::move(keyframe));
        return;
      }
      case SessionRecord::kLoop: {
        const SessionLoop loop = read_loop(frame.payload);
        loops_.insert_or_assign(loop.id, loop);
        return;
      }
      case SessionRecord::kPoses:
        for (const SessionPose& pose : read_poses(frame.payload)) {
          poses_.insert_or_assign(pose.id, pose.T_map_base);
        }
        return;
      case SessionRecord::kRetired: keyframes_.erase(read_retired(frame.payload)); return;
      case SessionRecord::kEnd: session_.closed = true; return;
    }
    throw SessionContentError("is of an unknown kind");
  }

  /// Numbers count up by one: what is missed, was lost.
  void count(std::uint32_t number) {
    ++session_.records;
    if (number > next_number_) {
      session_.lost_records += number - next_number_;
    }
    next_number_ = number + 1;
  }

  Session session_;
  std::string segment_;
  bool has_begun_ = false;
  bool is_foreign_ = false;  // this segment
  std::uint32_t next_number_ = 0;
  std::map<graph::KeyframeId, SessionKeyframe> keyframes_;
  std::map<graph::KeyframeId, geometry::Se3> poses_;
  std::map<graph::LoopId, SessionLoop> loops_;
};

/// Where the next record may begin, behind `from`.
std::size_t next_magic(std::span<const std::byte> bytes, std::size_t from) {
  std::array<std::byte, 4> magic{};
  store_le(std::span<std::byte>(magic), 0, RecordFrame::kMagic);
  const auto found = std::search(bytes.begin() + static_cast<std::ptrdiff_t>(from), bytes.end(), magic.begin(), magic.end());
  return static_cast<std::size_t>(found - bytes.begin());
}

void read_segment(std::span<const std::byte> bytes, Assembly& assembly) {
  std::size_t at = 0;
  std::optional<std::size_t> bad_from;
  std::string why;
  std::uint64_t patience = 8 * bytes.size() + RecordFrame::kMaxPayload;  // with bytes that only look like records
  const auto end_of_bad = [&](std::size_t end) {
    if (bad_from) {
      assembly.damaged(*bad_from, end - *bad_from, why);
      bad_from.reset();
    }
  };
  while (at < bytes.size()) {
    RecordFrame frame;
    const FrameVerdict verdict = read_frame(bytes.subspan(at), frame);
    if (verdict == FrameVerdict::kGood) {
      end_of_bad(at);
      if (const std::string wrong = assembly.take(frame); !wrong.empty()) {
        assembly.damaged(at, frame.bytes(), wrong);
      }
      at += frame.bytes();
      continue;
    }
    if (verdict == FrameVerdict::kNewerFormat) {
      end_of_bad(at);
      assembly.damaged(at, frame.bytes(), in_words(verdict));
      at += frame.bytes();
      continue;
    }
    if (!bad_from) {
      bad_from = at;
      why = in_words(verdict);
    }
    const std::uint64_t tried = verdict == FrameVerdict::kDamaged ? frame.bytes() : 0;
    if (tried > patience) {
      break;
    }
    patience -= tried;
    at = next_magic(bytes, at + 1);
  }
  end_of_bad(bytes.size());
}

}  // namespace

Session read_session(const fs::path& folder, const std::function<void(double)>& progress) {
  std::error_code error;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (is_segment_name(entry.path()) && entry.is_regular_file(error)) {
      files.push_back(entry.path());
    }
  }
  if (error) {
    throw std::runtime_error(folder.string() + ": " + error.message());
  }
  if (files.empty()) {
    throw std::runtime_error(folder.string() + ": holds no session (no file such as " + segment_name(0) + ")");
  }
  std::sort(files.begin(), files.end());
  Assembly assembly;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::vector<std::byte> bytes = bytes_of(files[i]);
    assembly.begin_segment(files[i].filename().string());
    assembly.session().bytes += bytes.size();
    ++assembly.session().segments;
    read_segment(bytes, assembly);
    if (progress) {
      progress(static_cast<double>(i + 1) / static_cast<double>(files.size()));
    }
  }
  if (!assembly.has_begun()) {
    throw std::runtime_error(folder.string() + ": holds no session: not one record of its files is whole");
  }
  return assembly.finish();
}

}  // namespace slamd::storage
