/* SPDX-License-Identifier: BSD-3-Clause
 * Loaded into a program (LD_PRELOAD), fails one of its calls as $SEPCAL_FAIL says:
 *   list            none; tells each call stack that memory is asked from, once
 *   allocation:N    the N-th request for memory
 *   allocations:N   that one and all that follow
 *   stack:H         the first request from the call stack of this hash
 *   thread:N        every start of a thread from the N-th on
 *   file:N          the N-th call that writes a file or names it
 * and writes what it did, a line each, to the file $SEPCAL_FAIL_LOG: "stack H of call N", "failed",
 * the frames of what failed, "crashed" and where. Its own code asks for no memory. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <link.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <unwind.h>

enum { most_frames = 64, most_modules = 96, slots = 1 << 16, log_number = 200 };

void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* old, size_t size);
void* __libc_memalign(size_t alignment, size_t size);

typedef enum { unread, off, list, allocation, allocations, stack, thread, file } Mode;

static _Atomic Mode mode = unread;
static uint64_t wanted;
static int log_to = -1;
static atomic_ulong requests;
static atomic_ulong threads;
static atomic_ulong file_calls;
static atomic_bool done;
static _Atomic uint64_t seen[slots];
static __thread bool inside __attribute__((tls_model("initial-exec")));

static struct {
  uintptr_t first, last, base;
} modules[most_modules];
static int module_count;

static void tell(const char* format, ...) {
  char line[512];
  va_list values;
  va_start(values, format);
  int length = vsnprintf(line, sizeof line, format, values);
  va_end(values);
  if (length > (int)sizeof line - 1) length = (int)sizeof line - 1;
  if (log_to >= 0 && length > 0 && write(log_to, line, (size_t)length) < 0) log_to = -1;
}

/* Where code lies: a place in a module is the same in every run. */
static int note_module(struct dl_phdr_info* info, size_t size, void* unused) {
  (void)size;
  (void)unused;
  for (int i = 0; i < info->dlpi_phnum && module_count < most_modules; ++i) {
    const ElfW(Phdr)* part = &info->dlpi_phdr[i];
    if (part->p_type != PT_LOAD || (part->p_flags & PF_X) == 0) continue;
    modules[module_count].base = info->dlpi_addr;
    modules[module_count].first = info->dlpi_addr + part->p_vaddr;
    modules[module_count].last = info->dlpi_addr + part->p_vaddr + part->p_memsz;
    ++module_count;
  }
  return 0;
}

static uint64_t place_of(uintptr_t address) {
  for (int i = 0; i < module_count; ++i) {
    if (address < modules[i].first || address >= modules[i].last) continue;
    return ((uint64_t)(i + 1) << 48U) ^ (address - modules[i].base);
  }
  return 0;
}

typedef struct {
  int count;
  uintptr_t addresses[most_frames];
} Frames;

static _Unwind_Reason_Code note_frame(struct _Unwind_Context* context, void* argument) {
  Frames* frames = argument;
  if (frames->count == most_frames) return _URC_END_OF_STACK;
  frames->addresses[frames->count++] = _Unwind_GetIP(context);
  return _URC_NO_REASON;
}

static uint64_t hash_of(const Frames* frames) {
  uint64_t hash = 0xcbf29ce484222325U;
  for (int i = 0; i < frames->count; ++i) {
    hash = (hash ^ place_of(frames->addresses[i])) * 0x100000001b3U;
    hash ^= hash >> 29U;
  }
  return hash | 1U;
}

static void tell_frames(const Frames* frames) {
  for (int i = 0; i < frames->count; ++i) {
    Dl_info info = {0};
    if (dladdr((void*)(frames->addresses[i] - 1), &info) == 0) continue;
    const char* folder = strrchr(info.dli_fname, '/');
    tell("  %s %s+0x%zx\n", folder ? folder + 1 : info.dli_fname,
         info.dli_sname ? info.dli_sname : "?",
         frames->addresses[i] - (uintptr_t)(info.dli_sname ? info.dli_saddr : info.dli_fbase));
  }
}

static void tell_failure(void) {
  Frames frames = {0};
  _Unwind_Backtrace(note_frame, &frames);
  tell("failed\n");
  tell_frames(&frames);
}

static void tell_crash(int signal) {
  inside = true;
  Frames frames = {0};
  _Unwind_Backtrace(note_frame, &frames);
  tell("crashed: signal %d\n", signal);
  tell_frames(&frames);
}

static void watch_crashes(void) {
  static char room[1 << 16];
  const stack_t other = {.ss_sp = room, .ss_size = sizeof room};
  sigaltstack(&other, NULL);
  struct sigaction action = {.sa_handler = tell_crash,
                             .sa_flags = SA_ONSTACK | (int)SA_RESETHAND | SA_NODEFER};
  for (const int* one = (int[]){SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, 0}; *one != 0; ++one) {
    sigaction(*one, &action, NULL);
  }
}

/* The first request may come before any constructor, but not before the environment is there. */
static Mode read_mode(void) {
  if (environ == NULL) return off;
  const char* asked = getenv("SEPCAL_FAIL");
  const char* log = getenv("SEPCAL_FAIL_LOG");
  Mode read = off;
  static const struct {
    const char* word;
    Mode mode;
  } words[] = {{"list", list},    {"allocation:", allocation}, {"allocations:", allocations},
               {"stack:", stack}, {"thread:", thread},         {"file:", file}};
  for (size_t i = 0; asked != NULL && i < sizeof words / sizeof *words; ++i) {
    const size_t length = strlen(words[i].word);
    if (strncmp(asked, words[i].word, length) != 0) continue;
    read = words[i].mode;
    wanted = strtoull(asked + length, NULL, read == stack ? 16 : 10);
  }
  if (read != off && log != NULL) {
    const int opened = open(log, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    log_to = fcntl(opened, F_DUPFD_CLOEXEC, log_number); /* out of the program's way */
    close(opened);
  }
  dl_iterate_phdr(note_module, NULL);
  if (read != off) watch_crashes();
  mode = read;
  return read;
}

static bool is_new(uint64_t hash) {
  for (uint64_t at = hash % slots, tried = 0; tried < slots; at = (at + 1) % slots, ++tried) {
    uint64_t there = 0;
    if (atomic_compare_exchange_strong(&seen[at], &there, hash)) return true;
    if (there == hash) return false;
  }
  return false;
}

static bool fails(unsigned long number) {
  if (mode == allocation) return number == wanted;
  if (mode == allocations) return number >= wanted;
  if ((mode != list && mode != stack) || (mode == stack && done)) return false;
  Frames frames = {0};
  _Unwind_Backtrace(note_frame, &frames);
  const uint64_t hash = hash_of(&frames);
  if (mode == stack) return hash == wanted && !atomic_exchange(&done, true);
  if (is_new(hash)) tell("stack %016llx of call %lu\n", (unsigned long long)hash, number);
  return false;
}

/* Whether this request for memory is to fail. */
static bool refuses(void) {
  if (inside) return false;
  inside = true;
  if (mode == unread) read_mode();
  bool failing = false;
  if (mode > off && mode <= stack) {
    const unsigned long number = ++requests;
    failing = fails(number);
    if (failing && (mode != allocations || number == wanted)) tell_failure();
  }
  inside = false;
  if (failing) errno = ENOMEM;
  return failing;
}

void* malloc(size_t size) { return refuses() ? NULL : __libc_malloc(size); }
void* calloc(size_t count, size_t size) { return refuses() ? NULL : __libc_calloc(count, size); }
void* realloc(void* old, size_t size) { return refuses() ? NULL : __libc_realloc(old, size); }
void* memalign(size_t alignment, size_t size) {
  return refuses() ? NULL : __libc_memalign(alignment, size);
}
void* aligned_alloc(size_t alignment, size_t size) {
  return refuses() ? NULL : __libc_memalign(alignment, size);
}
int posix_memalign(void** result, size_t alignment, size_t size) {
  const int before = errno;
  void* const room = refuses() ? NULL : __libc_memalign(alignment, size);
  errno = before;
  if (room == NULL) return ENOMEM;
  *result = room;
  return 0;
}

static void* next(const char* name) { return dlsym(RTLD_NEXT, name); }

int pthread_create(pthread_t* started, const pthread_attr_t* how, void* (*work)(void*),
                   void* argument) {
  if (mode == thread && ++threads >= wanted) {
    tell_failure();
    return EAGAIN;
  }
  int (*real)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*) = next("pthread_create");
  return real(started, how, work, argument);
}

/* Calls of the program and of libraries; what the C library calls by itself is not seen. */
static bool refuses_file(void) {
  if (mode != file || inside || ++file_calls != wanted) return false;
  inside = true;
  tell_failure();
  inside = false;
  errno = EIO;
  return true;
}

int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t permissions = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  if ((flags & (O_WRONLY | O_RDWR)) != 0 && refuses_file()) return -1;
  int (*real)(const char*, int, ...) = next("open");
  return real(path, flags, permissions);
}

ssize_t write(int number, const void* bytes, size_t count) {
  if (number != log_to && refuses_file()) return -1;
  ssize_t (*real)(int, const void*, size_t) = next("write");
  return real(number, bytes, count);
}

int close(int number) {
  int (*real)(int) = next("close");
  if (!refuses_file()) return real(number);
  real(number);
  errno = EIO;
  return -1;
}

#define FAILING(result, name, parameters, arguments) \
  result name parameters {                           \
    if (refuses_file()) return -1;                   \
    result(*real) parameters = next(#name);          \
    return real arguments;                           \
  }
FAILING(int, fsync, (int number), (number))
FAILING(int, fchmod, (int number, mode_t to), (number, to))
FAILING(int, fchown, (int number, uid_t user, gid_t group), (number, user, group))
FAILING(int, rename, (const char* from, const char* to), (from, to))
FAILING(int, linkat, (int folder, const char* from, int other, const char* to, int flags),
        (folder, from, other, to, flags))
