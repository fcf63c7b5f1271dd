#pragma once

#include <ctime>

namespace slamd::pose_graphs {

/// CPU time of this process: what else runs on the machine does not count. Units: s.
inline double cpu_s() {
  std::timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace slamd::pose_graphs
