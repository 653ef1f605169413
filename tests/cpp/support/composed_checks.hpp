// SPDX-License-Identifier: BSD-3-Clause
// Checks that every composed model goes through, made at compile time or at run time.
#pragma once

#include <string>
#include <vector>

#include "composed_models.hpp"
#include "sepcal/detail/compiled_models.hpp"
#include "sepcal/models/five_hole_probe.hpp"
#include "sepcal/models/magnetometer.hpp"

namespace sepcal::test {

inline const FiveHoleProbe five_holes{4.5, 4.0, {0.35, -0.1, -0.02}};

/// 60 rows of an aircraft, in two segments.
Record five_hole_record();

Record magnetometer_record();

/// D against differences of A xi1 + b (relative to each column), then check_model() with outputs of
/// the model's own.
void check_tangent(const BlockModel& model, Record record, const NamedValues& values,
                   double tolerance = 1e-7);

/// Derivatives with respect to each input against differences.
void check_input_tangent(const BlockModel& model, const Record& record, const NamedValues& values);

/// A xi1 + b (n_z * N).
Eigen::VectorXd predict(const BlockModel& model, const Record& record, const NamedValues& values);

/// A copy of the record with `column` instead of its column of that name.
Record with_column(const Record& record, const std::string& name,
                   const std::vector<double>& column);

std::vector<std::string> names_of(const std::vector<Variable>& variables);

}  // namespace sepcal::test
