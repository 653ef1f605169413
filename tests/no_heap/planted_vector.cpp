// SPDX-License-Identifier: BSD-3-Clause
// A fault for check_symbols.cmake to see: a vector on the heap.
#include "sepcal/detail/eigen.hpp"

double sum_of(int count);

double sum_of(int count) { return Eigen::VectorXd::Ones(count).eval().sum(); }
