// SPDX-License-Identifier: BSD-3-Clause
// How much a study draws: all of it in sepcal_studies, which scripts/study builds and runs; eight
// seeds in sepcal_tests, which has the same cases.
#pragma once

#include <algorithm>

namespace sepcal::test {

#ifdef SEPCAL_STUDIES
inline constexpr bool whole_study = true;
#else
inline constexpr bool whole_study = false;
#endif

constexpr int seeds(int all, int few = 8) { return whole_study ? all : std::min(all, few); }

}  // namespace sepcal::test
