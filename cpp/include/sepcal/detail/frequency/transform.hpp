// SPDX-License-Identifier: BSD-3-Clause
// The finite Fourier transform over a band, at any frequencies:
//   X(w) = sqrt(2 / N) sum_k x_k exp(-j w (t_k - t_m)),  t_m the middle of the N rows' times.
// White noise of variance s^2 has real and imaginary parts of variance s^2 each. What a drift does
// to the whole band is that its end doesn't meet its beginning; without_ends() takes that off. Both
// are linear: what is a sum of columns at every row is the same sum of their transforms.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "sepcal/detail/band.hpp"
#include "sepcal/record.hpp"

namespace sepcal {

/// The column `time` [s] in a segment's rows.
std::span<const double> time_of(const Record& record, const Segment& segment);

/// Of N rows: the last less the first time, and a median interval more [s].
double duration_of(std::span<const double> time);

/// Takes off every column (N x any number) the straight line of least squares; times, s.
Eigen::MatrixXd without_line(const Eigen::MatrixXd& columns, std::span<const double> time);

/// Rows are frequencies [Hz], columns those given (N x any number), as they stand.
Eigen::MatrixXcd fourier_transform(const Eigen::MatrixXd& columns, std::span<const double> time,
                                   std::span<const double> frequencies);

/// X (frequencies x any number), transformed from rows at these times, without what of each column
/// is a straight line over time: the transforms of 1 and t fitted to it by real factors.
Eigen::MatrixXcd without_ends(const Eigen::MatrixXcd& X, std::span<const double> time,
                              std::span<const double> frequencies);

}  // namespace sepcal
