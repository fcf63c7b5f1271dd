#pragma once

/// SLAMD_SANITIZED: 1 where AddressSanitizer or ThreadSanitizer is compiled in, whichever compiler says so, else 0. Then
/// frames are many times larger, and malloc is the sanitizer's own.
// NOLINTBEGIN(cppcoreguidelines-macro-usage): it chooses what is compiled
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SLAMD_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define SLAMD_SANITIZED 1
#endif
#endif
#ifndef SLAMD_SANITIZED
#define SLAMD_SANITIZED 0
#endif
// NOLINTEND(cppcoreguidelines-macro-usage)
