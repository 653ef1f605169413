// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/family_fit.hpp"

#include <algorithm>
#include <mutex>
#include <utility>

#include "diagnosis/noise_hypothesis.hpp"

namespace sepcal::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using noise::NoiseFamilies;
using noise::NoiseFamily;
using noise::NoiseMember;

/// Members for coefficients and coefficients for members, in turn until that gains little.
/// `problem`:
///   NoiseMembers find_members(coefficients)  the likeliest for what these leave
///   NoiseMembers differenced()               noise of the rows' differences
///   MatrixXd products(members)               [X e]' [X e] in their noise, of k columns
/// The coefficients for the last members are left for finish_fit().
template <class Problem>
FamilyFit climb(const Problem& problem, const VectorXd& start) {
  constexpr int most_rounds = 5;
  constexpr double least_gain = 0.05;
  FamilyFit best;
  best.minus_two_log_likelihood = infinity;
  best.coefficients = start;
  for (int round = 0; round < most_rounds; ++round) {
    NoiseMembers members = problem.find_members(best.coefficients);
    double value = 0.0;
    for (NoiseMember& member : members) {
      value += member.minus_two_log_likelihood;
      member.sigma = std::max(member.sigma, least_sigma);
    }
    const double gain = best.minus_two_log_likelihood - value;
    if (!(gain > 0.0)) break;  // the coefficients are those for the members before
    best.noise = std::move(members);
    best.minus_two_log_likelihood = value;
    best.covariance = {};
    if (gain < least_gain || round + 1 == most_rounds) break;
    finish_fit([&](const NoiseMembers& noise) { return problem.products(noise); }, best);
  }
  return best;
}

/// The likelier; the first where they are as good.
FamilyFit likelier(FamilyFit one, FamilyFit other) {
  constexpr double least_gain = 0.05;
  const double gain = one.minus_two_log_likelihood - other.minus_two_log_likelihood;
  return gain > least_gain ? std::move(other) : std::move(one);
}

/// From least squares, and from those of the rows' differences, where what is slow has no say:
/// columns that are noisy themselves make two maxima, one where they are loud and one where they
/// are not.
template <class Problem>
FamilyFit maximise(const Problem& problem, const VectorXd& start) {
  FamilyFit of_differences{.noise = problem.differenced(), .coefficients = start};
  finish_fit([&](const NoiseMembers& noise) { return problem.products(noise); }, of_differences);
  return likelier(climb(problem, start), climb(problem, of_differences.coefficients));
}

/// What was found, or what steps from the fit of the first of the columns alone lead to where that
/// is likelier.
template <class Problem>
FamilyFit no_less_likely(const Problem& problem, FamilyFit found, const FamilyFit& nested) {
  if (found.minus_two_log_likelihood < nested.minus_two_log_likelihood) return found;
  VectorXd start = VectorXd::Zero(found.coefficients.size());
  start.head(nested.coefficients.size()) = nested.coefficients;
  return likelier(std::move(found), climb(problem, start));
}

/// The same as maximise(), and no less likely than the fit of the first of the columns alone.
template <class Problem>
FamilyFit maximise_beyond(const Problem& problem, const VectorXd& start, const FamilyFit& nested) {
  return no_less_likely(problem, maximise(problem, start), nested);
}

/// From generalised least squares in a noise that the likeliest is near.
template <class Problem>
FamilyFit maximise_near(const Problem& problem, const NoiseMembers& near, Index count) {
  FamilyFit start{.noise = near, .coefficients = VectorXd::Zero(count)};
  finish_fit([&](const NoiseMembers& noise) { return problem.products(noise); }, start);
  return climb(problem, start.coefficients);
}

NoiseMembers differenced_noise(const NoiseFamilies& families, const std::vector<int>& orders) {
  NoiseMembers members;
  for (const int order : orders) {
    members.push_back({.family = NoiseFamily::fractional,
                       .at = families.fractions() - 1,
                       .partial = VectorXd::Zero(order)});
  }
  return members;
}

/// A residual of any length: its columns are made anew wherever they are asked for.
struct OneResidual {
  const NoiseFamilies& families;
  const RowLayout& layout;
  NoiseFamily family;
  const Columns& columns;
  const VectorXd& residual;
  const std::vector<int>& orders;
  const WhiteProducts& products;

  NoiseMembers differenced() const { return differenced_noise(families, orders); }

  NoiseMembers find_members(const VectorXd& coefficients) const {
    const VectorXd left = subtract(layout, residual, columns, coefficients);
    NoiseMembers members;
    for (std::size_t j = 0; j < orders.size(); ++j) {
      members.push_back(
          families.find(family, left.segment(layout.first(j), layout.rows), orders[j]));
    }
    return members;
  }
};

}  // namespace

std::array<FamilyFit, 2> fit_families(const NoiseFamilies& families, const RowLayout& layout,
                                      const Columns& columns, const VectorXd& residual,
                                      const std::vector<int>& orders, const WhiteProducts& products,
                                      const std::array<FamilyFit, 2>* nested) {
  const VectorXd start = multiply_transposed(layout, columns, residual);
  std::array<FamilyFit, 2> fits;
  for (std::size_t k = 0; k < fits.size(); ++k) {
    const OneResidual problem{families, layout,  noise::noise_families[k], columns, residual,
                              orders,   products};
    fits[k] = nested ? maximise_beyond(problem, start, (*nested)[k]) : maximise(problem, start);
  }
  return fits;
}

void finish_fit(const WhiteProducts& products, FamilyFit& fit) {
  if (fit.is_finished()) return;
  const Index k = fit.coefficients.size();
  const MatrixXd square = products(fit.noise);
  fit.covariance = pseudo_inverse(square.topLeftCorner(k, k));
  fit.coefficients = fit.covariance * square.col(k).head(k);
}

MatrixXd family_products(const NoiseFamilies& families, const RowLayout& layout,
                         const NoiseMembers& noise, const Columns& X, const VectorXd& e) {
  return white_products(layout, X, e, [&](std::size_t j, const Eigen::Ref<MatrixXd>& white) {
    families.whiten(noise[j], white);
  });
}

/// What the columns are in one output.
struct FamilyRegression::Output {
  /// X' R^-1 X of a Gauss-Markov member with sigma 1.
  struct Square {
    std::once_flag made;
    MatrixXd value;
  };

  MatrixXd columns;
  std::vector<MatrixXd> differences;         // of each of the fractional family's
  mutable std::vector<Square> gauss_markov;  // of each member of that family
};

FamilyRegression::FamilyRegression(const NoiseFamilies& families, const RowLayout& layout,
                                   MatrixXd columns, std::vector<int> orders)
    : families_(families),
      layout_(layout),
      columns_(std::move(columns)),
      orders_(std::move(orders)) {
  for (std::size_t j = 0; j < orders_.size(); ++j) {
    const MatrixXd own = columns_.middleRows(layout.first(j), layout.rows);
    std::vector<MatrixXd> differences;
    for (Index k = 0; k < own.cols(); ++k) {
      const MatrixXd column = families.differences(own.col(k));
      differences.resize(static_cast<std::size_t>(column.cols()), own);
      for (Index d = 0; d < column.cols(); ++d) {
        differences[static_cast<std::size_t>(d)].col(k) = column.col(d);
      }
    }
    outputs_.push_back(std::make_unique<Output>(Output{
        own, std::move(differences), std::vector<Output::Square>(families.gauss_markovs())}));
  }
}

FamilyRegression::~FamilyRegression() = default;

FamilyRegression::Residual FamilyRegression::take(const VectorXd& e) const {
  Residual residual;
  residual.regression_ = this;
  residual.e_ = e;
  for (std::size_t j = 0; j < outputs_.size(); ++j) {
    residual.differences_.push_back(families_.differences(of_output(e, j)));
  }
  return residual;
}

/// The problem that maximise() solves.
struct FamilyRegression::Residual::InFamily {
  const FamilyRegression& all;
  const Residual& residual;
  NoiseFamily family;
  Index count;  // columns

  NoiseMembers differenced() const { return differenced_noise(all.families_, all.orders_); }

  NoiseMembers find_members(const VectorXd& coefficients) const {
    NoiseMembers members;
    for (std::size_t j = 0; j < all.outputs_.size(); ++j) {
      const Output& output = *all.outputs_[j];
      if (family == NoiseFamily::fractional) {
        MatrixXd left = residual.differences_[j];
        for (Index d = 0; d < left.cols(); ++d) {
          left.col(d) -=
              output.differences[static_cast<std::size_t>(d)].leftCols(count) * coefficients;
        }
        members.push_back(all.families_.find_fractional(left, all.orders_[j]));
      } else {
        const VectorXd left =
            all.of_output(residual.e_, j) - output.columns.leftCols(count) * coefficients;
        members.push_back(all.families_.find(family, left, all.orders_[j]));
      }
    }
    return members;
  }

  MatrixXd products(const NoiseMembers& members) const {
    MatrixXd sum = MatrixXd::Zero(count + 1, count + 1);
    for (std::size_t j = 0; j < members.size(); ++j) {
      if (members[j].family == NoiseFamily::fractional) {
        add_fractional(members[j], j, sum);
      } else {
        add_gauss_markov(members[j], j, sum);
      }
    }
    return sum;
  }

  void add_fractional(const NoiseMember& member, std::size_t j, MatrixXd& sum) const {
    const auto d = static_cast<Index>(member.at);
    MatrixXd white(all.layout_.rows, count + 1);
    white << all.outputs_[j]->differences[member.at].leftCols(count),
        residual.differences_[j].col(d);
    all.families_.whiten_differenced(member, white);
    sum.noalias() += white.transpose() * white;
  }

  void add_gauss_markov(const NoiseMember& member, std::size_t j, MatrixXd& sum) const {
    const Output& output = *all.outputs_[j];
    Output::Square& square = output.gauss_markov[member.at];
    std::call_once(square.made, [&] {
      MatrixXd white = output.columns;
      NoiseMember unit = member;
      unit.sigma = 1.0;
      all.families_.whiten(unit, white);
      square.value = white.transpose() * white;
    });
    const VectorXd e = all.of_output(residual.e_, j);
    MatrixXd white = e;
    all.families_.whiten(member, white);
    sum(count, count) += white.squaredNorm();
    all.families_.whiten_backwards(member, white.col(0));
    const VectorXd shares = output.columns.leftCols(count).transpose() * white.col(0);
    sum.col(count).head(count) += shares;
    sum.row(count).head(count) += shares.transpose();
    sum.topLeftCorner(count, count) +=
        square.value.topLeftCorner(count, count) / (member.sigma * member.sigma);
  }
};

FamilyFit FamilyRegression::Residual::fit(NoiseFamily family, Index count) const {
  const InFamily problem{*regression_, *this, family, count};
  const VectorXd start = regression_->columns_.leftCols(count).transpose() * e_;
  FamilyFit fit = maximise(problem, start);
  finish_fit([&](const NoiseMembers& noise) { return problem.products(noise); }, fit);
  return fit;
}

FamilyRegression::Residual::Nested FamilyRegression::Residual::compare(const NoiseMembers& near,
                                                                       Index fewer) const {
  const NoiseFamily family = near.front().family;
  const Index all = regression_->columns();
  const FamilyFit without =
      maximise_near(InFamily{*regression_, *this, family, fewer}, near, fewer);
  const InFamily problem{*regression_, *this, family, all};
  const FamilyFit with = no_less_likely(problem, maximise_near(problem, near, all), without);
  return {without.minus_two_log_likelihood, with.minus_two_log_likelihood};
}

}  // namespace sepcal::diagnosis
