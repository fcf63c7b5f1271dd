#pragma once

#include "tools/report/content.hpp"

namespace slamd::report {

/// Returns what a drive around a block of houses would be reported with: 100 m × 60 m, 60 s, with a
/// recovery, a degraded stretch, truth, and the plain filter beside it.
ReportContent drive_around_the_block();

}  // namespace slamd::report
