// SPDX-License-Identifier: BSD-3-Clause
// Eigen, for the public headers. It aligns by the instruction set that a file is compiled for, and
// would so free with one allocator what another one gave: a program and libsepcal must agree,
// whatever flags each was compiled with. The CMake targets pass the definitions on.
#pragma once

#include <Eigen/Core>

static_assert(EIGEN_DEFAULT_ALIGN_BYTES == 64 && EIGEN_MAX_STATIC_ALIGN_BYTES == 64,
              "sepcal and its users must align Eigen's memory alike: link the CMake target "
              "sepcal::sepcal, or compile everything that includes Eigen with "
              "-DEIGEN_MAX_ALIGN_BYTES=64 -DEIGEN_MAX_STATIC_ALIGN_BYTES=64");

#if EIGEN_VERSION_AT_LEAST(3, 4, 90)  // Eigen 5 keeps the word for all rows or columns elsewhere
namespace Eigen {
using placeholders::all;
}
#endif
