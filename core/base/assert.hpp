#pragma once

#include <cstdio>
#include <cstdlib>

namespace slamd {

/// Reports a programmer error and aborts; bad data and bad configuration never come here.
[[noreturn]] inline void assertion_failed(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "%s:%d: assertion failed: %s\n", file, line, condition);
  std::abort();
}

}  // namespace slamd

/// An assertion that stays on in every build (style.md, "Errors": programmer errors only).
// NOLINTNEXTLINE(cppcoreguidelines-macro-usage): file, line and condition need the preprocessor
#define SLAMD_ASSERT(condition) \
  ((condition) ? static_cast<void>(0) : ::slamd::assertion_failed(#condition, __FILE__, __LINE__))
