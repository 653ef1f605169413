// SPDX-License-Identifier: BSD-3-Clause
// Seeded randomness for the simulators: the outputs' noise, and columns that drive nothing.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "sepcal/simulation/simulate.hpp"

namespace sepcal::simulation {

/// A Mersenne twister with our own uniform and Box-Muller, for the standard library's
/// distributions differ from one implementation to the next.
class RandomNumbers {
 public:
  explicit RandomNumbers(std::uint64_t seed) : engine_(seed) {}

  double draw_normal();   // of the standard normal distribution
  double draw_uniform();  // in [0, 1), 53 bits

 private:
  std::mt19937_64 engine_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

/// Noise of standard deviation 1, (rows x outputs), outputs independent of each other. bursty: over
/// the record, the mean square is 1 in expectation.
Eigen::MatrixXd make_noise(NoiseKind kind, std::size_t rows, Eigen::Index outputs,
                           std::uint64_t seed);

/// Appends decoy_1, ..., as many as `options` says, to a flight with time_s. Throws Error for more
/// than 1,000.
void add_decoys(SimulatedFlight& flight, const SimulationOptions& options);

}  // namespace sepcal::simulation
