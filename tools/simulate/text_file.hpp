#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>

namespace slamd::simulate {

/// A file that is written with fprintf. Errors: RecordingError when it cannot be opened or written whole.
class TextFile {
 public:
  explicit TextFile(const std::filesystem::path& file);

  std::FILE* stream() { return stream_.get(); }
  void close();

 private:
  std::filesystem::path file_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream_;
};

}  // namespace slamd::simulate
