#pragma once

#include <string>
#include <vector>

#include "tools/sensors/remarks.hpp"
#include "tools/sensors/seen.hpp"

namespace slamd::sensors {

/// Everything as one line of JSON, with its line end.
std::string to_json(const Seen& seen, const std::vector<Remark>& remarks);

}  // namespace slamd::sensors
