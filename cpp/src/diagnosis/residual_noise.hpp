// SPDX-License-Identifier: BSD-3-Clause
// What the residual of each output is like, before anybody explains it.
#pragma once

#include <vector>

#include "diagnosis/null_hypothesis.hpp"
#include "sepcal/diagnosis.hpp"

namespace sepcal::diagnosis {

/// One entry a used output.
std::vector<ResidualNoise> describe_residual(const NullHypothesis& null);

}  // namespace sepcal::diagnosis
