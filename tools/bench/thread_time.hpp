#pragma once

#include <ctime>

namespace slamd::bench {

/// CPU time of the calling thread: what else runs on the machine does not count. Units: s.
inline double thread_cpu_s() {
  std::timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace slamd::bench
