// SPDX-License-Identifier: BSD-3-Clause
// An effect that is put into measurements, to see whether a diagnosis would find it.
#pragma once

#include <string>
#include <vector>

#include "base/parameter_values.hpp"
#include "base/thread_pool.hpp"
#include "sepcal/detail/effect.hpp"
#include "sepcal/detail/eigen.hpp"
#include "sepcal/detail/named_effects.hpp"
#include "sepcal/flight/flight_diagnosis.hpp"

namespace sepcal::verbs {

/// Throws Error where the last of the settings is among those before it.
void check_new(const std::vector<EffectSetting>& settings);

/// The end of the name of the parameter that shapes the effect's driver, ".t0"; empty: it has none.
std::string shape_of(const Effect& effect);

/// A model that has the effect, and a fit's estimates, which lack it.
struct WithInjected {
  const BlockModel& model;
  const Record& record;
  base::ParameterValues estimates;
  std::string shape;  // shape_of()
};

/// What the effect adds to every output at the estimates (rows x n_z, of the whole record), zero
/// outside its segments; notes the sizes. Throws Error for another number of them than one or the
/// effect's coefficients.
Eigen::MatrixXd added_outputs(const WithInjected& with, const SizedEffect& injected,
                              Injection& injection, base::ThreadPool& pool);

/// The record with something added to its outputs; it views its other columns.
Record with_outputs(const Record& record, const std::vector<Variable>& outputs,
                    const Eigen::MatrixXd& added);

/// Where the injected effect came; in the first place too where it would have done as well as the
/// first.
void judge_injection(const Diagnosis& diagnosis, Injection& injection);

}  // namespace sepcal::verbs
