// SPDX-License-Identifier: BSD-3-Clause
// A band of frequencies, and those in it that a record tells.
#pragma once

#include <vector>

namespace sepcal {

/// Frequencies, Hz. The default band holds what a rigid aircraft does.
struct Band {
  double low = 0.1;
  double high = 2.0;
  double spacing = 0.0;  // Hz; 0: multiples of one over the length of a segment, where noises are
                         // independent
};

/// Throws Error for a band that is empty, not finite or below zero.
void check_band(const Band& band);

/// low, low + spacing, ... up to high, or the multiples of 1 / seconds between them, of rows that
/// last `seconds`. Throws Error as check_band()
/// does, for a band that holds less than two such frequencies, and for more than 100,000.
std::vector<double> frequencies_of(const Band& band, double seconds);

/// Of segments that last so long [s], those too short for two frequencies with none. Throws Error
/// as frequencies_of() does of the longest.
std::vector<std::vector<double>> frequencies_of(const Band& band,
                                                const std::vector<double>& seconds);

}  // namespace sepcal
