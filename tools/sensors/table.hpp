#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "tools/sensors/remarks.hpp"
#include "tools/sensors/seen.hpp"

namespace slamd::sensors {

/// One sensor, line or bus, in words: what it is, where, and what came of it in the last second.
struct Row {
  std::string name;
  std::string place;
  std::string rates;
};

std::vector<Row> rows_of(const Seen& seen);

struct Look {
  std::size_t rows = 24;     // no more lines than this; what is cut comes last
  std::size_t columns = 80;  // no wider than this
};

/// Draws everything, a line each, without moving the cursor.
std::string draw(const Seen& seen, const std::vector<Remark>& remarks, const Look& look);

/// The rows of one second, as lines of a log.
std::string second_as_lines(const Seen& seen);

/// The remarks, as lines; says so where there are none.
std::string remarks_as_lines(const std::vector<Remark>& remarks);

}  // namespace slamd::sensors
