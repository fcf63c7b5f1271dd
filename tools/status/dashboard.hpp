#pragma once

#include <cstddef>
#include <string>

#include "tools/status/listener.hpp"

namespace slamd::status {

struct Look {
  std::string url;
  std::string prefix;
  bool colour = false;
  std::size_t rows = 24;     // no more lines than this; what is cut is the least important
  std::size_t columns = 80;  // no wider than this
};

/// Draws what has been heard, a line each, without moving the cursor.
std::string draw(const Heard& heard, Clock::time_point now, const Look& look);

}  // namespace slamd::status
