// SPDX-License-Identifier: BSD-3-Clause
// TWOSTEP, Alonso & Shuster's calibration of a magnetometer of which only the field's strength is
// known (J. Astronaut. Sci. 50, 2002: of the bias alone, pp. 433-451, and complete, pp. 477-490).
// Readings B with (I + D) B = A h + b + noise of covariance Sigma, D symmetric, |h| = F:
//   z = |B|^2 - F^2 = L theta - |b(theta)|^2 + v,   theta = (c, E), c = (I + D) b, E = 2 D + D^2
//   L = [2 B', -(B_x^2, B_y^2, B_z^2, 2 B_x B_y, 2 B_x B_z, 2 B_y B_z)],   |b|^2 = c' (I + E)^-1 c
// First step: the weighted means are taken off both sides, and with them the one term that is not
// linear, |b|^2. Second step: Gauss-Newton, with the equation of the means back. Where F is the
// same in every row, the first step of the complete calibration says nothing: (c, E) = (0, -I)
// fulfils it exactly, and without noise so does a whole line. The second step then begins at a
// perfect sensor.
#pragma once

#include <string>
#include <vector>

#include "sepcal/detail/eigen.hpp"
#include "sepcal/record.hpp"

namespace sepcal::rivals {

struct AlonsoShusterOptions {
  double noise = 0.3;       // sigma [uT], Sigma = sigma^2 I; above zero
  bool bias_alone = false;  // E = 0
  /// Weights are those of a perfect sensor, then so many times those of the estimate before.
  int reweightings = 1;
  /// The mean of v. In print it is -tr Sigma; the mean of |h + noise|^2 - |h|^2 is +tr Sigma, and
  /// the printed sign makes the scale factors larger by 3 sigma^2 / F^2.
  bool mean_as_printed = true;
  int iterations = 100;       // of the second step, each time
  std::string segments = {};  // as in Record::select(); empty: all
};

/// As AttitudeIndependentMagnetometer has it: B = C h + n with C = C_alpha C_lambda.
struct AlonsoShusterFit {
  bool converged = false;
  std::string message;  // one line; empty where there is nothing to say
  /// lambda_x, lambda_y, lambda_z, alpha_xy, alpha_xz, alpha_yz [1], n_x, n_y, n_z [uT]; of the
  /// bias alone the last three.
  std::vector<std::string> names;
  Eigen::VectorXd estimates;
  Eigen::VectorXd standard_errors;  // NaN where there are none
  Eigen::MatrixXd covariance;
  Eigen::Vector3d bias;     // n [uT]
  Eigen::Matrix3d shape;    // C C' = (I + E)^-1
  Eigen::VectorXd theta;    // c [uT] and E_xx, E_yy, E_zz, E_xy, E_xz, E_yz, or b [uT] alone
  Eigen::VectorXd centred;  // the first step's
  double cost = 0.0;        // half the weighted squares of the second step
  int iterations = 0;       // of the second step, in all
};

/// Columns mx, my, mz [uT], and field_change [uT] where the field changes along the record: what a
/// row's has more than `field_strength` [uT]. Throws Error for columns that are missing, fewer rows
/// than parameters, a strength or noise that is not positive.
AlonsoShusterFit fit_alonso_shuster(const Record& record, double field_strength,
                                    const AlonsoShusterOptions& options = {});

}  // namespace sepcal::rivals
