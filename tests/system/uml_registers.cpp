// Lets Debian 12's user-mode Linux run on processors with more registers than it knows (AMX). It keeps the first 2,696
// bytes of what the host gives as a process's extended registers, and gives only those back, which the host then refuses.
// Preloaded by uml.bash: what it does not know stays as it is.
#include <dlfcn.h>
#include <elf.h>
#include <sys/ptrace.h>
#include <sys/uio.h>

#include <algorithm>
#include <cstdarg>
#include <cstdint>
#include <cstring>

namespace {

using Ptrace = long (*)(__ptrace_request, ...);

alignas(64) unsigned char whole[1 << 16];

long set_extended(Ptrace next, pid_t process, void* kind, const iovec& wanted) {
  iovec all{whole, sizeof whole};
  if (next(PTRACE_GETREGSET, process, kind, &all) != 0) {
    return -1;
  }
  std::memcpy(whole, wanted.iov_base, std::min(wanted.iov_len, all.iov_len));
  return next(PTRACE_SETREGSET, process, kind, &all);
}

}  // namespace

extern "C" long ptrace(__ptrace_request request, ...) noexcept {
  static const Ptrace next = reinterpret_cast<Ptrace>(dlsym(RTLD_NEXT, "ptrace"));
  va_list arguments;
  va_start(arguments, request);
  const pid_t process = va_arg(arguments, pid_t);
  void* const address = va_arg(arguments, void*);
  void* const data = va_arg(arguments, void*);
  va_end(arguments);
  if (request == PTRACE_SETREGSET && reinterpret_cast<std::uintptr_t>(address) == NT_X86_XSTATE) {
    return set_extended(next, process, address, *static_cast<const iovec*>(data));
  }
  return next(request, process, address, data);
}
