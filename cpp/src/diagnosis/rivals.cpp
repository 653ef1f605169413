// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/rivals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "diagnosis/projection.hpp"
#include "diagnosis/refits.hpp"

namespace sepcal::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

using Findings = std::vector<EffectFinding>;

/// What of an effect's columns is the same in every row.
Columns constant_share(const CandidateColumns& columns) {
  return {columns.whole.cols(), [columns](Index first, Eigen::Ref<MatrixXd> rows) {
            MatrixXd varying(rows.rows(), rows.cols());
            columns.varying.fill(first, varying);
            columns.whole.fill(first, rows);
            rows -= varying;
          }};
}

/// The model's own parameters by a fit with an effect, where this is at its mean over the record:
/// where it is zero is a matter of its driver.
VectorXd estimates_of(const CandidateTesting& testing, const Alternative& alternative) {
  const CandidateRoom& room = testing.room();
  const Fit& fit = alternative.fit;
  const auto values_of = [&fit](const auto& entries, const auto& name_of) {
    VectorXd values(static_cast<Index>(entries.size()));
    for (std::size_t k = 0; k < entries.size(); ++k) {
      values[static_cast<Index>(k)] = fit[name_of(entries[k])].value;
    }
    return values;
  };
  const VectorXd own = values_of(room.fit().parameters, std::identity());
  const VectorXd effect = values_of(alternative.candidate.coefficients,
                                    [](const Variable& coefficient) { return coefficient.name; });
  const std::string& of_shape = alternative.candidate.shape.parameter;
  const double shape = of_shape.empty() ? alternative.shape : fit[of_shape].value;
  const Columns share = constant_share(room.columns(alternative.candidate, shape));
  const VectorXd shift = explained_by(testing.null().basis, share) * effect;
  return own + shift;
}

const Alternative* contender_of(const ModelSelection& selection, const std::string& name) {
  const auto found =
      std::ranges::find_if(selection.alternatives, [&](const Alternative& alternative) {
        return alternative.candidate.name == name && std::isfinite(alternative.criterion);
      });
  return found == selection.alternatives.end() ? nullptr : &*found;
}

/// What another fit has elsewhere.
struct Clash {
  double errors = 0.0;  // how many of its errors a parameter is taken away from there
  std::string sentence = {};
  const EffectFinding* rival = nullptr;
};

/// The parameter that comes furthest away, were the rival the cause, by the larger of the two
/// standard errors. `errors`: with what is advised.
Clash compare(const CandidateTesting& testing, const VectorXd& now, const VectorXd& errors,
              const Alternative& rival) {
  const std::vector<std::string>& names = testing.room().fit().parameters;
  const VectorXd truth = estimates_of(testing, rival);
  Clash worst;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto at = static_cast<Index>(k);
    const double before = testing.fitted().fit[names[k]].value;
    const double error = std::max(errors[at], rival.fit[names[k]].standard_error);
    const double away = (std::abs(now[at] - truth[at]) - std::abs(before - truth[at])) / error;
    if (!(away > worst.errors)) continue;
    worst = {away, fmt::format("{} would do as well, and has {} at {:.4g} where this takes it from "
                               "{:.4g} to {:.4g}",
                               rival.candidate.name, names[k], truth[at], before, now[at])};
  }
  return worst;
}

VectorXd errors_of(const CandidateTesting& testing, const Fit& fit) {
  const std::vector<std::string>& names = testing.room().fit().parameters;
  VectorXd errors(static_cast<Index>(names.size()));
  for (std::size_t k = 0; k < names.size(); ++k) {
    errors[static_cast<Index>(k)] = fit[names[k]].standard_error;
  }
  return errors;
}

}  // namespace

std::string find_rival(CandidateTesting& testing, ModelSelection& selection,
                       const EffectFinding& advised, const Findings& findings) {
  constexpr double most_errors = 1.5;
  const Alternative* chosen = contender_of(selection, advised.name);
  if (!chosen) return {};
  const VectorXd with_chosen = estimates_of(testing, *chosen);
  const auto find_clashes = [&](const VectorXd& errors) {
    std::vector<Clash> clashes;
    for (const EffectFinding& finding : findings) {
      const bool is_as_good = finding.beside == Beside::equivalent || &finding == &findings.front();
      const Alternative* rival = contender_of(selection, finding.name);
      if (!is_as_good || !rival || rival == chosen) continue;
      // What explains no more with many more coefficients is no cause to doubt the plain one.
      if (rival->criterion > chosen->criterion + as_likely ||
          is_far_simpler(chosen->candidate, rival->candidate)) {
        continue;
      }
      Clash clash = compare(testing, with_chosen, errors, *rival);
      if (clash.errors > most_errors) {
        clash.rival = &finding;
        clashes.push_back(std::move(clash));
      }
    }
    std::ranges::sort(clashes, std::ranges::greater(), &Clash::errors);
    return clashes;
  };
  if (find_clashes(errors_of(testing, chosen->fit)).empty()) return {};
  const Fit coloured =  // whose errors are larger, if any
      refit_nearly(testing.room(), chosen->candidate, chosen->shape, enough_rows, true);
  for (const Clash& clash : find_clashes(errors_of(testing, coloured))) {
    // What would be withheld itself is no reason to withhold another.
    if (object(testing, selection, *clash.rival).reason.empty()) return clash.sentence;
  }
  return {};
}

}  // namespace sepcal::diagnosis
