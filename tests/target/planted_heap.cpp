// SPDX-License-Identifier: BSD-3-Clause
// A program that asks for memory, which the list of its symbols has to show.
#include <cstddef>

#include "link.hpp"

/// What newlib's malloc asks of a board.
extern "C" void* _sbrk(std::ptrdiff_t) { return nullptr; }

void fly() {
  Eigen::VectorXd x(target::read_count());
  x.setZero();
  target::write_all(x);
}
