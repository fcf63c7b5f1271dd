#pragma once

#include <string>
#include <vector>

#include "tools/bench/campaign.hpp"

namespace slamd::bench {

/// Returns the outcomes as a table of text, a row each, and medians by sensor.
std::string table_of(const std::vector<Outcome>& outcomes);

/// Returns one self-contained HTML page: the table, and the position error over time for each world.
std::string page_of(const std::string& campaign, const std::vector<Outcome>& outcomes);

}  // namespace slamd::bench
