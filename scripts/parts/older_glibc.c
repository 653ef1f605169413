// SPDX-License-Identifier: BSD-3-Clause
// What g++ 12 and its standard library ask of a glibc newer than 2.28, for the wheels of
// older_glibc.cmake: the linker's --wrap sends calls here.
#include <math.h>
#include <pthread.h>
#include <stdint.h>
#include <sys/random.h>
#include <time.h>

// glibc 2.29 gave these functions a new version, without the old one's handling of errors.
#ifdef __x86_64__
#define FIRST "GLIBC_2.2.5"
#else
#define FIRST "GLIBC_2.17"
#endif
#define TAKE_FIRST(name) __asm__(".symver first_" #name "," #name "@" FIRST)
#define WRAP(name)              \
  double first_##name(double);  \
  TAKE_FIRST(name);             \
  double __wrap_##name(double); \
  double __wrap_##name(double x) { return first_##name(x); }
WRAP(exp)
WRAP(exp2)
WRAP(log)
WRAP(log2)
double first_pow(double, double);
TAKE_FIRST(pow);
double __wrap_pow(double, double);
double __wrap_pow(double x, double y) { return first_pow(x, y); }

// glibc 2.30: waits until a time of any clock. Before it there is the clock of the wall alone.
int __wrap_pthread_cond_clockwait(pthread_cond_t*, pthread_mutex_t*, clockid_t,
                                  const struct timespec*);
int __wrap_pthread_cond_clockwait(pthread_cond_t* condition, pthread_mutex_t* mutex, clockid_t clock,
                                  const struct timespec* until) {
  const long second = 1000000000;
  struct timespec now;
  struct timespec wall;
  clock_gettime(clock, &now);
  clock_gettime(CLOCK_REALTIME, &wall);
  wall.tv_sec += until->tv_sec - now.tv_sec;
  wall.tv_nsec += until->tv_nsec - now.tv_nsec;
  for (; wall.tv_nsec < 0; wall.tv_nsec += second) --wall.tv_sec;
  for (; wall.tv_nsec >= second; wall.tv_nsec -= second) ++wall.tv_sec;
  return pthread_cond_timedwait(condition, mutex, &wall);
}

// glibc 2.32: whether shared counters need no atomic operation; they are given one.
char __libc_single_threaded = 0;

// glibc 2.36, for std::random_device.
uint32_t arc4random(void);
uint32_t arc4random(void) {
  uint32_t value = 0;
  while (getrandom(&value, sizeof value, 0) != (ssize_t)sizeof value) continue;
  return value;
}
