// SPDX-License-Identifier: BSD-3-Clause
#include "estimation/acceleration.hpp"

#include <Eigen/QR>

namespace sepcal::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int plain_turns = 2;        // what settles fast does so by itself
constexpr std::size_t most_kept = 4;  // differences; older turns saw another slope
constexpr double farthest = 1.0;      // of a logarithm
constexpr int most_failed = 2;        // from then on plain turns, of which each lowers J

}  // namespace

VectorXd Acceleration::next(const VectorXd& tried, const VectorXd& found) {
  const VectorXd to = found.array().log();
  const VectorXd change = to - VectorXd(tried.array().log());
  if (!change.allFinite()) {
    turns_.clear();
    return found;
  }
  if (!turns_.empty() && change.norm() >= turns_.back().change.norm()) {
    turns_.clear();
    ++failed_;
  }
  turns_.push_back({to, change});
  if (turns_.size() > most_kept + 1) turns_.erase(turns_.begin());
  if (plain_++ < plain_turns || turns_.size() < 2 || failed_ > most_failed) return found;
  const auto count = static_cast<Index>(turns_.size()) - 1;
  MatrixXd changes(change.size(), count);  // from a turn to the next
  MatrixXd moves(change.size(), count);
  for (Index k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(k);
    changes.col(k) = turns_[i + 1].change - turns_[i].change;
    moves.col(k) = turns_[i + 1].found - turns_[i].found;
  }
  const VectorXd further = -moves * changes.colPivHouseholderQr().solve(change);
  if (!further.allFinite() || further.cwiseAbs().maxCoeff() > farthest) return found;
  return (to + further).array().exp();
}

}  // namespace sepcal::estimation
