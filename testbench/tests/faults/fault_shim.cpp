// Stands between a program and the C library, by LD_PRELOAD, and lets a call fail that hardly ever does.
//
// FAULT_CALL=FUNCTION:N makes the Nth call of a function fail, counted from the start of main over all processes that are forked: malloc
// (and all that comes down to it), open (for files of the program, by whatever name), write, fsync, rename, mkdir, close. `short:N` lets
// the Nth write take only half of its bytes, which is no error. FAULT_COUNT=FILE leaves there how often each was called. FAULT_LOG=FILE
// leaves there what decides what a power cut would leave, a line each: `write PATH`, `sync PATH`, `rename FROM TO`, tabs between.

#include <dlfcn.h>
#include <execinfo.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <initializer_list>

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
}

namespace {

enum function : unsigned { call_malloc, call_open, call_write, call_short, call_fsync, call_rename, call_mkdir, call_close, functions };
constexpr const char* names[functions] = {"malloc", "open", "write", "short", "fsync", "rename", "mkdir", "close"};

struct shared_counts {
  std::atomic<long> calls[functions];
};
shared_counts* counts = nullptr;  // in memory that forked processes share; none before main
unsigned failing = functions;
long failing_call = 0;
int log_file = -1;
int count_file = -1;

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

/// Whether a library asks for the memory that does not look whether it gets it (SystemC's and OpenImageIO's table of strings, but for what
/// they ask of `new`), or that ends the process itself (GLib, behind OpenImageIO).
bool is_unchecked() {
  void* frames[8];
  const int depth = backtrace(frames, 8);
  Dl_info own{}, caller{};
  dladdr(reinterpret_cast<void*>(&is_unchecked), &own);
  for (int i = 0; i < depth; ++i) {
    if (dladdr(frames[i], &caller) == 0 || caller.dli_fname == nullptr) return false;
    const bool passes_on = caller.dli_fbase == own.dli_fbase || std::strstr(caller.dli_fname, "/libc.so") != nullptr;  // strdup
    if (passes_on) continue;
    for (const char* library : {"libsystemc", "libglib", "libOpenImageIO_Util"})
      if (std::strstr(caller.dli_fname, library) != nullptr) return true;
    return false;
  }
  return false;
}

/// Counts a call, and tells whether it is the one to fail.
bool fails(function f) {
  if (counts == nullptr) return false;
  const long call = ++counts->calls[f];
  return f == failing && call == failing_call && !(f == call_malloc && is_unchecked());
}

void log_line(const char* what, const char* first, const char* second) {
  if (log_file < 0 || counts == nullptr) return;
  char line[3 * PATH_MAX];
  const int n = std::snprintf(line, sizeof line, second != nullptr ? "%s\t%s\t%s\n" : "%s\t%s\n", what, first, second);
  syscall(SYS_write, log_file, line, static_cast<std::size_t>(n));
}

void log_descriptor(const char* what, int descriptor) {
  if (log_file < 0 || counts == nullptr) return;
  char name[64], path[PATH_MAX];
  std::snprintf(name, sizeof name, "/proc/self/fd/%d", descriptor);
  const ssize_t n = readlink(name, path, sizeof path - 1);
  if (n < 0) return;
  path[n] = '\0';
  log_line(what, path, nullptr);
}

int open_beside(const char* name, int flags) {
  const int descriptor = static_cast<int>(syscall(SYS_openat, AT_FDCWD, name, flags | O_CLOEXEC, 0644));
  const int high = fcntl(descriptor, F_DUPFD_CLOEXEC, 500);  // out of the program's way
  syscall(SYS_close, descriptor);
  return high;
}

void leave_counts() {
  if (counts == nullptr || count_file < 0) return;
  char line[512];
  int n = 0;
  for (unsigned f = 0; f < functions; ++f)
    n += std::snprintf(line + n, sizeof line - static_cast<std::size_t>(n), "%s %ld\n", names[f], counts->calls[f].load());
  if (pwrite(count_file, line, static_cast<std::size_t>(n), 0) != n) return;
}

using main_function = int (*)(int, char**, char**);
main_function program = nullptr;

int counted_main(int argc, char** argv, char** environment) {
  if (const char* call = std::getenv("FAULT_CALL")) {
    const char* const colon = std::strchr(call, ':');
    for (unsigned f = 0; f < functions; ++f)
      if (colon != nullptr && std::strncmp(names[f], call, static_cast<std::size_t>(colon - call)) == 0) failing = f;
    if (failing == functions) std::abort();
    failing_call = std::atol(colon + 1);
  }
  if (const char* name = std::getenv("FAULT_LOG")) log_file = open_beside(name, O_WRONLY | O_CREAT | O_APPEND);
  if (const char* name = std::getenv("FAULT_COUNT")) count_file = open_beside(name, O_WRONLY | O_CREAT | O_TRUNC);
  std::atexit(leave_counts);
  is_unchecked();  // the first backtrace loads a library
  void* const memory = mmap(nullptr, sizeof(shared_counts), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) std::abort();
  counts = static_cast<shared_counts*>(memory);
  return program(argc, argv, environment);
}

mode_t mode_of(int flags, va_list list) { return (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(list, mode_t) : 0; }

/// The kernel's own files: libraries end the process where they can't read them.
bool is_of_kernel(const char* name) { return std::strncmp(name, "/proc/", 6) == 0 || std::strncmp(name, "/sys/", 5) == 0; }

int open_counted(int folder, const char* name, int flags, mode_t mode) {
  if (!is_of_kernel(name) && fails(call_open)) {
    errno = EMFILE;
    return -1;
  }
  return static_cast<int>(syscall(SYS_openat, folder, name, flags, mode));
}

std::FILE* open_stream(const char* real, const char* name, const char* mode) {
  if (!is_of_kernel(name) && fails(call_open)) {
    errno = EMFILE;
    return nullptr;
  }
  return next<std::FILE* (*)(const char*, const char*)>(real)(name, mode);
}

}  // namespace

extern "C" {

int __libc_start_main(main_function entry, int argc, char** argv, void (*init)(), void (*fini)(), void (*rtld_fini)(), void* stack_end) {
  program = entry;
  using start = int (*)(main_function, int, char**, void (*)(), void (*)(), void (*)(), void*);
  return next<start>("__libc_start_main")(counted_main, argc, argv, init, fini, rtld_fini, stack_end);
}

void* malloc(std::size_t bytes) {
  if (fails(call_malloc)) {
    errno = ENOMEM;
    return nullptr;
  }
  return __libc_malloc(bytes);
}

void* calloc(std::size_t count, std::size_t bytes) {
  if (fails(call_malloc)) {
    errno = ENOMEM;
    return nullptr;
  }
  return __libc_calloc(count, bytes);
}

void* realloc(void* old, std::size_t bytes) {
  if (fails(call_malloc)) {
    errno = ENOMEM;
    return nullptr;
  }
  return __libc_realloc(old, bytes);
}

void* aligned_alloc(std::size_t alignment, std::size_t bytes) {
  if (fails(call_malloc)) {
    errno = ENOMEM;
    return nullptr;
  }
  return __libc_memalign(alignment, bytes);
}

int open(const char* name, int flags, ...) {
  va_list list;
  va_start(list, flags);
  const mode_t mode = mode_of(flags, list);
  va_end(list);
  return open_counted(AT_FDCWD, name, flags, mode);
}

int open64(const char* name, int flags, ...) {
  va_list list;
  va_start(list, flags);
  const mode_t mode = mode_of(flags, list);
  va_end(list);
  return open_counted(AT_FDCWD, name, flags, mode);
}

int openat(int folder, const char* name, int flags, ...) {
  va_list list;
  va_start(list, flags);
  const mode_t mode = mode_of(flags, list);
  va_end(list);
  return open_counted(folder, name, flags, mode);
}

std::FILE* fopen(const char* name, const char* mode) { return open_stream("fopen", name, mode); }
std::FILE* fopen64(const char* name, const char* mode) { return open_stream("fopen64", name, mode); }

ssize_t write(int descriptor, const void* bytes, std::size_t count) {
  if (descriptor > STDERR_FILENO) {
    log_descriptor("write", descriptor);
    if (fails(call_write)) {
      errno = ENOSPC;
      return -1;
    }
    if (fails(call_short) && count > 1) count /= 2;
  }
  return syscall(SYS_write, descriptor, bytes, count);
}

int fsync(int descriptor) {
  if (fails(call_fsync)) {
    errno = EIO;
    return -1;
  }
  log_descriptor("sync", descriptor);
  return static_cast<int>(syscall(SYS_fsync, descriptor));
}

int rename(const char* from, const char* to) {
  if (fails(call_rename)) {
    errno = EIO;
    return -1;
  }
  log_line("rename", from, to);
  return static_cast<int>(syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}

int mkdir(const char* name, mode_t mode) {
  if (fails(call_mkdir)) {
    errno = ENOSPC;
    return -1;
  }
  return static_cast<int>(syscall(SYS_mkdirat, AT_FDCWD, name, mode));
}

int close(int descriptor) {
  const bool fault = fails(call_close);
  const int status = static_cast<int>(syscall(SYS_close, descriptor));
  if (!fault) return status;
  errno = EIO;
  return -1;
}

}  // extern "C"
