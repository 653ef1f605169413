// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/pair_set.hpp"

#include <algorithm>
#include <cmath>

#include "diagnosis/projection.hpp"

namespace sepcal::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t most_paired = 10;
constexpr std::size_t most_lines = 12;  // of either screen's best
constexpr std::size_t most_pairs = 12;
constexpr double within = 9.2;  // of the least criterion

/// One trial, or two, and Schwarz's criterion of what they explain.
struct Combination {
  std::vector<std::size_t> members = {};
  double criterion = 0.0;  // -(what they explain) + ln(count) a direction + scans
};

/// The surest trials, each at its best shape, beyond the tangent.
struct Causes {
  std::vector<const Trial*> trials;
  std::vector<Columns> bases;  // orthonormal, of each
};

Causes choose_causes(const CandidateTesting& testing, const Trials& trials, bool of_lines) {
  const auto counts = [&](const Trial& trial) {
    const bool fits =
        of_lines ? is_of_lines(trial.candidate, 1) : trial.candidate.settings.size() == 1;
    return trial.visible && fits;
  };
  const std::vector<std::size_t> chosen =
      of_lines ? best_of(trials, most_lines, counts)
               : best_of(trials, most_paired, counts, {&Trial::log10_p});
  Causes causes;
  for (const std::size_t i : chosen) causes.trials.push_back(&trials[i]);
  for (const Trial* trial : causes.trials) {
    causes.bases.push_back(
        project_trial(testing.room(), testing.null(), *trial, trial->shape).basis);
  }
  return causes;
}

/// What the causes explain of the residual in one noise, by the products of their columns there.
class Explained {
 public:
  Explained(const CandidateTesting& testing, const Causes& causes, const NoiseMembers& noise) {
    const NullHypothesis& null = testing.null();
    Columns columns = null.basis.columns();
    for (const Columns& basis : causes.bases) {
      first_.push_back(columns.cols() - null.basis.rank());
      columns = join(columns, basis);
    }
    first_.push_back(columns.cols() - null.basis.rank());
    for (const Trial* trial : causes.trials) {
      scans_.push_back(2.0 * std::log(trial->candidate.shape.tried));
    }
    products_ = products_beyond(null.test->products(noise, columns, null.fit().residual),
                                null.basis.rank());
    penalty_ = std::log(static_cast<double>(null.fit().layout.count()));
  }

  Combination combine(std::vector<std::size_t> members) const {
    std::vector<Index> columns;
    double scans = 0.0;
    for (const std::size_t member : members) {
      scans += scans_[member];
      for (Index k = first_[member]; k < first_[member + 1]; ++k) columns.push_back(k);
    }
    const VectorXd shares = products_(columns, products_.cols() - 1);
    const MatrixXd square = products_(columns, columns);
    const double explained = shares.dot(pseudo_inverse(square) * shares);
    return {std::move(members), penalty_ * static_cast<double>(columns.size()) + scans - explained};
  }

 private:
  std::vector<Index> first_;   // column of each cause
  std::vector<double> scans_;  // penalty for each cause's shapes
  MatrixXd products_;          // of the causes and, last, the residual
  double penalty_ = 0.0;       // of a direction
};

bool is_scanned(const Trial& trial) { return !trial.candidate.shape.parameter.empty(); }

/// Every pair of which one at most was scanned, best first.
std::vector<Combination> rank_pairs(const Explained& explained, const Causes& causes) {
  std::vector<Combination> pairs;
  for (std::size_t a = 0; a < causes.trials.size(); ++a) {
    for (std::size_t b = a + 1; b < causes.trials.size(); ++b) {
      if (is_scanned(*causes.trials[a]) && is_scanned(*causes.trials[b])) continue;
      pairs.push_back(explained.combine({a, b}));
    }
  }
  std::ranges::stable_sort(pairs, {}, &Combination::criterion);
  return pairs;
}

}  // namespace

std::vector<std::string> find_pair_set(const CandidateTesting& testing, const Trials& trials,
                                       const NoiseMembers& noise, bool of_lines) {
  const Causes causes = choose_causes(testing, trials, of_lines);
  const Explained explained(testing, causes, noise);
  const auto ranked = rank_pairs(explained, causes);
  if (ranked.empty()) return {};
  std::vector<double> alone;
  for (std::size_t a = 0; a < causes.trials.size(); ++a) {
    alone.push_back(explained.combine({a}).criterion);
  }
  const double least = std::min(ranked.front().criterion, std::ranges::min(alone));
  std::vector<std::string> pairs;
  for (const Combination& pair : ranked) {
    if (!(pair.criterion < least + within) || pairs.size() == most_pairs) break;
    const std::size_t a = pair.members[0];
    const std::size_t b = pair.members[1];
    if (!(pair.criterion < std::min(alone[a], alone[b]))) continue;
    pairs.push_back(causes.trials[a]->candidate.name + "+" + causes.trials[b]->candidate.name);
  }
  return pairs;
}

}  // namespace sepcal::diagnosis
