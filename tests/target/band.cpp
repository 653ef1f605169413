// SPDX-License-Identifier: BSD-3-Clause
// The recursive Fourier transform in flight: q' = Ma alpha + Mq q + Md elevator + c at twenty
// frequencies, without a differentiation in time, in SCALAR.
#include "link.hpp"
#include "sepcal/core.hpp"

void fly() {
  using Scalar = SCALAR;
  const auto frequencies = target::read_vector<Scalar, 20>();
  const auto forgetting = target::read();
  static sepcal::RecursiveBand<4, 20, Scalar> band(
      frequencies, {.forgetting = forgetting, .differentiate = true});
  target::Worst of_row;
  target::Worst of_estimate;
  int refused = 0;
  sepcal::BandEstimate<4, Scalar> found;
  const int rows = target::read_count();
  for (int k = 0; k < rows; ++k) {
    const auto time = static_cast<Scalar>(target::read());
    const auto reading = target::read_vector<Scalar, 3>();  // alpha, q, elevator
    const Eigen::Vector<Scalar, 4> regressors(reading[0], reading[1], reading[2], Scalar(1));
    refused += of_row.of([&] { return band.absorb(time, regressors, reading[1]); }) ? 0 : 1;
    if (k % 25 == 24) found = of_estimate.of([&] { return band.estimate(); });
  }
  target::write(refused);
  target::write_all(found.xi);
  target::write_all(found.deviation);
  target::write(of_row.most());
  target::write(of_estimate.most());
}
