#include "tests/support/allocation_guard.hpp"

#include "core/base/sanitizer.hpp"

#if SLAMD_SANITIZED

namespace slamd::support {

bool allocation_guard_available() {
  return false;
}

std::size_t detail::allocations_of_this_thread() {
  return 0;
}

}  // namespace slamd::support

#else

#include <bit>
#include <cerrno>

namespace {

// Constant-initialised and in the executable, so that reading it in malloc never allocates itself.
constinit thread_local std::size_t allocations = 0;

}  // namespace

namespace slamd::support {

bool allocation_guard_available() {
  return true;
}

std::size_t detail::allocations_of_this_thread() {
  return allocations;
}

}  // namespace slamd::support

// glibc's own entry points, behind the names that we take over; free stays glibc's.
// NOLINTBEGIN(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp): the names are glibc's
extern "C" {

void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) noexcept {
  ++allocations;
  return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) noexcept {
  ++allocations;
  return __libc_calloc(count, size);
}

void* realloc(void* old, std::size_t size) noexcept {
  ++allocations;
  return __libc_realloc(old, size);
}

void* memalign(std::size_t alignment, std::size_t size) noexcept {
  ++allocations;
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  ++allocations;
  return __libc_memalign(alignment, size);
}

int posix_memalign(void** result, std::size_t alignment, std::size_t size) noexcept {
  ++allocations;
  if (!std::has_single_bit(alignment) || alignment % sizeof(void*) != 0) {
    return EINVAL;
  }
  void* memory = __libc_memalign(alignment, size);
  if (memory == nullptr) {
    return ENOMEM;
  }
  *result = memory;
  return 0;
}

}  // extern "C"
   // NOLINTEND(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp)

#endif
