// SPDX-License-Identifier: BSD-3-Clause
#include <utility>

#include "results.hpp"

namespace sepcal::bindings {
namespace {

/// By name, of the parameters that stage one samples: nonlinear and not fixed.
std::vector<OutputValue> named_point(const Fit& fit, const Eigen::VectorXd& xi2) {
  std::vector<OutputValue> point;
  Eigen::Index k = 0;
  for (auto at = fit.parameters.begin() + fit.n_1; at != fit.parameters.end(); ++at) {
    if (!at->fixed && k < xi2.size()) point.push_back({at->name, xi2[k++]});
  }
  return point;
}

/// Takes stage one out of the fit.
NamedStageOne take_stage_one(Fit& fit) {
  NamedStageOne named{.samples = fit.stage_one.samples.transpose(),
                      .best = named_point(fit, fit.stage_one.best),
                      .minima = {},
                      .rest = std::exchange(fit.stage_one, {})};
  named.rest.samples.resize(0, 0);
  for (const LocalMinimum& minimum : named.rest.minima) {
    named.minima.push_back({named_point(fit, minimum.xi2), minimum.trace_r});
  }
  return named;
}

}  // namespace

FittedModel fitted_model(Fit fit, std::vector<EffectSetting> effects, Page page) {
  NamedStageOne stage_one = take_stage_one(fit);
  return {std::move(fit), std::move(stage_one), std::move(effects), std::move(page)};
}

}  // namespace sepcal::bindings
