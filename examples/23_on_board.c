// SPDX-License-Identifier: BSD-3-Clause
// A flight program with a calibration in it: magnetometer.h is what `sepcal-mag export --to c` wrote.
// Of each line, x y z [uT] as read and the current [A], it prints the field that is there [uT].
#include "magnetometer.h"

#include <stdio.h>

int main(void) {
  double m_ut[3];
  double h_ut[3];
  double current_a;
  if (sepcal_magnetometer_self_test() != 0) {
    fputs("the header's self-test fails on this processor: do not fly\n", stderr);
    return 1;
  }
  while (scanf("%lf %lf %lf %lf", &m_ut[0], &m_ut[1], &m_ut[2], &current_a) == 4) {
    if (sepcal_magnetometer_correct(m_ut, current_a, h_ut) == sepcal_magnetometer_ok) {
      printf("%.4f %.4f %.4f\n", h_ut[0], h_ut[1], h_ut[2]);
    } else {
      puts("no reading");  // an input is no number: h_ut is not set
    }
  }
  return 0;
}
