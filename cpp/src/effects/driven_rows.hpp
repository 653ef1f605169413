// SPDX-License-Identifier: BSD-3-Clause
// What a driver comes to over a whole record.
#pragma once

#include <Eigen/Core>

#include "sepcal/detail/driver.hpp"
#include "sepcal/record.hpp"

namespace sepcal::effects {

/// phi at a shape over the record (length x functions); NaN outside the segments and where a delay
/// reaches beyond one.
Eigen::MatrixXd drive(const Driver& driver, double shape, const Record& record);

}  // namespace sepcal::effects
