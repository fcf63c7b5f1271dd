// Preloaded into a program (LD_PRELOAD), counts the heap calls of each named thread from its first instruction to its
// last, and writes them at exit to the file that SLAMD_HEAP_WATCH names, a line each:
//
//   NAME ALLOCATIONS FREES FIRST_CALLER
//
// ALLOCATIONS: malloc, calloc, realloc and the aligned ones; operator new ends there. FIRST_CALLER is where the first
// call came from, "-" when there was none. The thread that loads the program is called "main".
#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <bit>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

struct Thread {
  pthread_t handle{};
  std::atomic<std::uint64_t> allocations{0};
  std::atomic<std::uint64_t> frees{0};
  std::atomic<void*> first_caller{nullptr};
};

struct Name {
  pthread_t handle{};
  std::array<char, 16> text{};
};

// Constant-initialised: they are used before any constructor has run.
constinit std::array<Thread, 256> threads{};
constinit std::atomic<std::size_t> thread_count{0};
constinit std::array<Name, 256> names{};
constinit std::atomic<std::size_t> name_count{0};

// Initial-exec, so that the first use in a thread does not itself allocate.
[[gnu::tls_model("initial-exec")]] constinit thread_local Thread* own = nullptr;

Thread& this_thread() {
  if (own == nullptr) {
    const std::size_t index = thread_count.fetch_add(1);
    if (index >= threads.size()) {
      std::abort();  // better than counts that are not whole
    }
    own = &threads[index];
    own->handle = pthread_self();
  }
  return *own;
}

void count(std::atomic<std::uint64_t> Thread::*what, void* caller) {
  Thread& thread = this_thread();
  (thread.*what).fetch_add(1, std::memory_order_relaxed);
  void* none = nullptr;
  thread.first_caller.compare_exchange_strong(none, caller);
}

void note_name(pthread_t handle, const char* text) {
  const std::size_t index = name_count.fetch_add(1);
  if (index < names.size()) {
    names[index].handle = handle;
    std::strncpy(names[index].text.data(), text, names[index].text.size() - 1);
  }
}

[[gnu::constructor]] void begin() { note_name(pthread_self(), "main"); }

void write_line(int file, const Name& name) {
  static constinit Thread idle{};
  const Thread* thread = &idle;
  for (std::size_t i = 0; i < thread_count; ++i) {
    thread = pthread_equal(threads[i].handle, name.handle) != 0 ? &threads[i] : thread;
  }
  char caller[256] = "-";
  if (void* address = thread->first_caller) {
    Dl_info info{};
    const bool known = dladdr(address, &info) != 0 && info.dli_fname != nullptr;
    const auto offset = known ? reinterpret_cast<std::uintptr_t>(address) - reinterpret_cast<std::uintptr_t>(info.dli_fbase) : 0;
    std::snprintf(caller, sizeof caller, "%s+0x%zx", known ? info.dli_fname : "?", static_cast<std::size_t>(offset));
  }
  char line[400];
  const int length = std::snprintf(line, sizeof line, "%s %llu %llu %s\n", name.text.data(),
                                   static_cast<unsigned long long>(thread->allocations), static_cast<unsigned long long>(thread->frees), caller);
  [[maybe_unused]] const ssize_t written = write(file, line, static_cast<std::size_t>(length));
}

[[gnu::destructor]] void report() {
  const char* path = std::getenv("SLAMD_HEAP_WATCH");
  const int file = path == nullptr ? -1 : open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) {
    return;
  }
  for (std::size_t i = 0; i < name_count && i < names.size(); ++i) {
    write_line(file, names[i]);
  }
  close(file);
}

}  // namespace

// glibc's own entry points, behind the names that are taken over.
// NOLINTBEGIN(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp): the names are glibc's
extern "C" {

void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* memory);

void* malloc(std::size_t size) noexcept {
  count(&Thread::allocations, __builtin_return_address(0));
  return __libc_malloc(size);
}

void* calloc(std::size_t number, std::size_t size) noexcept {
  count(&Thread::allocations, __builtin_return_address(0));
  return __libc_calloc(number, size);
}

void* realloc(void* old, std::size_t size) noexcept {
  count(&Thread::allocations, __builtin_return_address(0));
  return __libc_realloc(old, size);
}

void* memalign(std::size_t alignment, std::size_t size) noexcept {
  count(&Thread::allocations, __builtin_return_address(0));
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  count(&Thread::allocations, __builtin_return_address(0));
  return __libc_memalign(alignment, size);
}

int posix_memalign(void** result, std::size_t alignment, std::size_t size) noexcept {
  count(&Thread::allocations, __builtin_return_address(0));
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

void free(void* memory) noexcept {
  if (memory != nullptr) {
    count(&Thread::frees, __builtin_return_address(0));
  }
  __libc_free(memory);
}

int pthread_setname_np(pthread_t thread, const char* name) noexcept {
  using SetName = int (*)(pthread_t, const char*);
  static const auto set_name = reinterpret_cast<SetName>(dlsym(RTLD_NEXT, "pthread_setname_np"));
  note_name(thread, name);
  return set_name(thread, name);
}

}  // extern "C"
// NOLINTEND(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp)
