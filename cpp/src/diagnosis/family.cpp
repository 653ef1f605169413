// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/family.hpp"

#include <algorithm>
#include <cmath>

#include "diagnosis/projection.hpp"
#include "numerics/tails.hpp"

namespace sepcal::diagnosis {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double good_part = 0.2;     // of what the first explains
constexpr double significant = -2.0;  // log10 of a tail

bool share_port(const Candidate& a, const Candidate& b) {
  return std::ranges::any_of(a.effects, [&](const Effect& effect) {
    return !effect.port.empty() &&
           std::ranges::find(b.effects, effect.port, &Effect::port) != b.effects.end();
  });
}

/// What an orthonormal basis explains of a residual.
double explained(const MatrixXd& basis, const VectorXd& residual) {
  return (basis.transpose() * residual).squaredNorm();
}

double log10_tail(double drop, const Trial& trial) {
  return log10_scan(trial) + numerics::log10_chi_squared_tail(std::max(0.0, drop), trial.freedom);
}

}  // namespace

bool are_alike(const Trial& first, const Trial& other, double correlation) {
  return canonical_correlation(first.thinned_basis, other.thinned_basis) > correlation;
}

Family::Family(const CandidateRoom& room, const NullHypothesis& null, const Trial& first,
               double correlation)
    : room_(room), null_(null), first_(first), correlation_(correlation) {
  residual_ = remove_span(null.basis, room.fit().residual);
  basis_ = orthonormal_basis(beyond_tangent(first));
  MatrixXd white = null.basis;
  null.test->whiten(first.ratios.with.noise, white);
  white_null_ = orthonormal_basis(white);
  white_basis_ = orthonormal_basis(whiten_beside(basis_));
  white_residual_ = whiten_beside(residual_);
}

MatrixXd Family::beyond_tangent(const Trial& trial) const {
  return remove_span(null_.basis, room_.columns(trial.candidate, trial.shape));
}

MatrixXd Family::whiten_beside(const MatrixXd& columns) const {
  MatrixXd white = columns;
  null_.test->whiten(first_.ratios.with.noise, white);
  return remove_span(white_null_, white);
}

bool Family::is_proxy(const Trial& other, double threshold) const {
  if (other.log10_plain > threshold || !share_port(first_.candidate, other.candidate)) return false;
  const MatrixXd beyond = beyond_tangent(other);
  const double alone = explained(orthonormal_basis(beyond), residual_);
  if (alone < good_part * explained(basis_, residual_)) return false;
  const double more =
      explained(orthonormal_basis(remove_span(basis_, beyond)), remove_span(basis_, residual_));
  return more < (1.0 - correlation_ * correlation_) * alone;
}

Family::Drops Family::drops_with(const Trial& other) const {
  const MatrixXd white = whiten_beside(beyond_tangent(other));
  Drops drops;
  drops.first = explained(white_basis_, white_residual_);
  drops.other = explained(orthonormal_basis(white), white_residual_);
  drops.both = drops.first + explained(orthonormal_basis(remove_span(white_basis_, white)),
                                       remove_span(white_basis_, white_residual_));
  return drops;
}

bool Family::is_rival(const Trial& other) const {
  if (!other.tested) return false;
  const Drops drops = drops_with(other);
  return log10_tail(drops.other, other) < significant &&
         log10_tail(drops.both - drops.first, other) > significant &&
         log10_tail(drops.both - drops.other, first_) > significant;
}

bool Family::is_enough(const Trial& other) const {
  const Drops drops = drops_with(other);
  return log10_tail(drops.both - drops.other, first_) > significant;
}

}  // namespace sepcal::diagnosis
