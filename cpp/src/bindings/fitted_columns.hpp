// SPDX-License-Identifier: BSD-3-Clause
// Columns that a fit is asked about, with the model and the options as the fit had them.
#pragma once

#include <memory>
#include <vector>

#include "bindings.hpp"

namespace sepcal::bindings {

/// Columns brought to the model that was fitted to them or their like.
struct FittedColumns {
  std::shared_ptr<const Probe> probe;
  std::shared_ptr<const BlockModel> model;
  Record record;
  FitOptions options;
};

FittedColumns bring_to_fit(const Model& model, Record record, const CalibrationOptions& options,
                           std::vector<EffectSetting> settings, const Fit& fit);

}  // namespace sepcal::bindings
