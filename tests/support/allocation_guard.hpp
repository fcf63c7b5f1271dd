#pragma once

#include <cstddef>
#include <utility>

namespace slamd::support {

/// Tells whether this build counts allocations; the sanitizers own malloc, so under them it does
/// not.
bool allocation_guard_available();

namespace detail {

/// Returns how often this thread has called the malloc family since it started.
std::size_t allocations_of_this_thread();

}  // namespace detail

/// Runs function and returns how often it called the malloc family (malloc, calloc, realloc and the
/// aligned ones; each operator new and Eigen's dynamic matrices end there) in this thread. Freeing
/// is not counted. Calls may nest. Where the guard is not available the result is 0: begin the test
/// with SLAMD_NEEDS_ALLOCATION_GUARD(), which skips it visibly.
template <typename Function>
std::size_t count_allocations(Function&& function) {
  const std::size_t before = detail::allocations_of_this_thread();
  std::forward<Function>(function)();
  return detail::allocations_of_this_thread() - before;
}

}  // namespace slamd::support

/// Skips the test, saying why, in a build that cannot count allocations (ASan, TSan).
// NOLINTNEXTLINE(cppcoreguidelines-macro-usage): GTEST_SKIP returns from the test's own body
#define SLAMD_NEEDS_ALLOCATION_GUARD()                                               \
  do {                                                                               \
    if (!::slamd::support::allocation_guard_available()) {                           \
      GTEST_SKIP() << "allocation guard not available: a sanitizer replaces malloc"; \
    }                                                                                \
  } while (false)
