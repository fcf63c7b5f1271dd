#include "tools/simulate/text_file.hpp"

#include <cerrno>
#include <cstring>

#include "drivers/recording/packet.hpp"

namespace slamd::simulate {

TextFile::TextFile(const std::filesystem::path& file)
    : file_(file), stream_(std::fopen(file.c_str(), "wb"), std::fclose) {
  if (!stream_) {
    throw recording::RecordingError(file, std::strerror(errno));
  }
}

void TextFile::close() {
  const bool failed = std::ferror(stream_.get()) != 0;
  if (std::fclose(stream_.release()) != 0 || failed) {
    throw recording::RecordingError(file_, "could not be written whole");
  }
}

}  // namespace slamd::simulate
