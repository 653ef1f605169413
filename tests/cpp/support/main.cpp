// SPDX-License-Identifier: BSD-3-Clause
// The tests' entry point.
#define DOCTEST_CONFIG_IMPLEMENT_WITH_MAIN
#include <doctest/doctest.h>
