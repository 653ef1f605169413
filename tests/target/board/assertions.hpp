// SPDX-License-Identifier: BSD-3-Clause
// Included before everything on the target: Eigen's assertions stay on and end the program, which
// says so. (EIGEN_NO_MALLOC is no proof: with NDEBUG the object still refers to malloc.)
#pragma once

#ifdef __cplusplus
extern "C" [[noreturn]] void trapped(const char* what);
// NOLINTNEXTLINE(cppcoreguidelines-macro-usage): Eigen's own
#define eigen_assert(condition)            \
  do {                                     \
    if (!(condition)) trapped(#condition); \
  } while (false)
#endif
