// SPDX-License-Identifier: BSD-3-Clause
// An exported header on board: what its self-test says, and the instructions that it takes.
#include "link.hpp"

extern "C" int self_test();

void fly() {
  target::Worst worst;
  target::write(worst.of([] { return self_test(); }));
  target::write(worst.most());
}
