// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/detail/identifiability.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/sentences.hpp"
#include "base/short_number.hpp"
#include "numerics/decompositions.hpp"
#include "sepcal/detail/quantity.hpp"

namespace sepcal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double share_to_take_part = 0.05;        // of the largest, in units of the scale
constexpr double share_to_be_weak_together = 0.3;  // of the largest, in columns of unit length
constexpr double share_to_be_inflated = 0.1;       // the same where most of a variance comes of it
constexpr double share_to_be_written = 0.01;       // of the largest, in the combination's own
constexpr double singular_floor = 1e-12;           // of the largest singular value: as good as zero
constexpr double weak_singular_value = 1.0 / 50.0;
constexpr std::size_t most_names = 8;         // that a sentence lists
constexpr std::size_t most_combinations = 3;  // that a sentence lists
constexpr std::size_t most_sentences = 3;     // that a message holds

/// Those with at least `share` of the largest, largest first.
std::vector<Index> participants(const VectorXd& direction, double share) {
  std::vector<Index> order(static_cast<std::size_t>(direction.size()));
  std::iota(order.begin(), order.end(), Index{0});
  const double limit = share * direction.cwiseAbs().maxCoeff();
  std::erase_if(order, [&](Index k) { return !(std::abs(direction[k]) > limit); });
  std::ranges::stable_sort(
      order, [&](Index a, Index b) { return std::abs(direction[a]) > std::abs(direction[b]); });
  return order;
}

VectorXd only(const VectorXd& values, const std::vector<Index>& kept) {
  VectorXd result = VectorXd::Zero(values.size());
  for (const Index k : kept) result[k] = values[k];
  return result;
}

std::vector<std::string> names_of(const std::vector<Index>& indices,
                                  const std::vector<std::string>& names) {
  std::vector<std::string> result;
  result.reserve(indices.size());
  for (const Index k : indices) result.push_back(names[static_cast<std::size_t>(k)]);
  return result;
}

/// How many of `size` entries to write out: all, unless two or more can be left out.
std::size_t within(std::size_t most, std::size_t size) { return size > most + 1 ? most : size; }

/// "a, b and c"; of more than `most` + 1 the first `most`, the others counted: "a, b and 7 more".
std::string spoken_list(const std::vector<std::string>& names, std::size_t most,
                        const std::string& where_to_look = "") {
  const std::size_t spoken = within(most, names.size());
  std::string text;
  for (std::size_t i = 0; i < spoken; ++i) {
    if (i > 0) text += i + 1 == names.size() ? " and " : ", ";
    text += names[i];
  }
  if (spoken == names.size()) return text;
  return text + " and " + std::to_string(names.size() - spoken) + " more" + where_to_look;
}

/// A length of one where none is known: nothing measures that parameter, whatever its length.
VectorXd usable(const VectorXd& scale) {
  return scale.unaryExpr([](double x) { return std::isfinite(x) && x > 0 ? x : 1.0; });
}

/// A direction xi + t d along which the residuals stay as they are.
struct Valley {
  VectorXd direction;  // in the parameters' own units
  std::vector<Index> parameters;
  Combination combination;
};

/// Valleys that have a parameter in common, joined into groups, in order.
std::vector<std::vector<Valley>> group(const std::vector<Valley>& valleys) {
  const auto share = [](const Valley& a, const Valley& b) {
    return std::ranges::find_first_of(a.parameters, b.parameters) != a.parameters.end();
  };
  std::vector<std::vector<Valley>> groups;
  for (const Valley& valley : valleys) {
    std::vector<Valley> joined{valley};
    std::erase_if(groups, [&](std::vector<Valley>& members) {
      if (std::ranges::none_of(members,
                               [&](const Valley& other) { return share(valley, other); })) {
        return false;
      }
      joined.insert(joined.begin(), members.begin(), members.end());
      return true;
    });
    groups.push_back(std::move(joined));
  }
  return groups;
}

std::string sentence(const std::vector<Valley>& valleys, const std::vector<std::string>& names) {
  std::vector<std::string> involved;
  std::vector<std::string> open;
  for (const Valley& valley : valleys) {
    for (const std::string& name : valley.combination.parameters) {
      if (std::ranges::find(involved, name) == involved.end()) involved.push_back(name);
    }
    open.push_back(valley.combination.text);
  }
  std::string text = spoken_list(involved, most_names) + " can't be told apart: ";
  if (valleys.size() == 1 && involved.size() == 2) {
    const Valley& valley = valleys.front();
    VectorXd determined = VectorXd::Zero(valley.direction.size());
    determined[valley.parameters[0]] = valley.direction[valley.parameters[1]];
    determined[valley.parameters[1]] = -valley.direction[valley.parameters[0]];
    return text + "only " + combination_text(determined, names) + " is determined";
  }
  return text + spoken_list(open, most_combinations, " (see unobservable)") +
         (open.size() == 1 ? " is" : " are") + " not determined";
}

/// What identify() is asked.
struct Question {
  const MatrixXd& R;
  const std::vector<std::string>& names;
  VectorXd scale;
  double noise_factor;
};

/// Where R, in coordinates where one means "as far as is plausible", is singular or below the
/// noise; `rank` is what is left.
std::vector<Valley> find_valleys(const Question& question, int& rank) {
  const auto& [R, names, s, noise_factor] = question;
  const Eigen::JacobiSVD<MatrixXd> svd(R * s.asDiagonal(), Eigen::ComputeFullV);
  const auto& singular = svd.singularValues();
  std::vector<Index> open;
  for (Index i = 0; i < R.cols(); ++i) {
    const bool zero = !(singular[i] > singular_floor * singular[0]);
    if (!zero) ++rank;
    if (zero || noise_factor > singular[i]) open.push_back(i);
  }
  const MatrixXd basis = sparsify(svd.matrixV()(Eigen::all, open));
  std::vector<Valley> valleys;
  for (Index i = 0; i < basis.cols(); ++i) {
    const std::vector<Index> involved = participants(basis.col(i), share_to_take_part);
    const VectorXd v = only(basis.col(i), involved);
    const VectorXd functional = v.cwiseQuotient(s);
    const double length = (R * s.cwiseProduct(v)).norm();
    Valley valley{s.cwiseProduct(v),
                  involved,
                  {names_of(involved, names), combination_text(functional, names), infinity}};
    if (length > singular_floor * singular[0]) {
      valley.combination.standard_error = noise_factor / length / functional.norm();
    }
    valleys.push_back(std::move(valley));
  }
  return valleys;
}

void list_unobservable(const std::vector<Valley>& valleys, const std::vector<std::string>& names,
                       Identifiability& result) {
  std::vector<std::string> unseen;  // by themselves, in exchange for nothing
  for (const auto& members : group(valleys)) {
    for (const Valley& valley : members) result.unobservable.push_back(valley.combination);
    if (members.size() == 1 && members.front().parameters.size() == 1) {
      unseen.push_back(members.front().combination.parameters.front());
    } else {
      result.sentences.push_back(base::one_sentence(sentence(members, names)));
    }
  }
  if (unseen.empty()) return;
  result.sentences.push_back(
      base::one_sentence(spoken_list(unseen, most_names, " (see unobservable)") +
                         " can't be determined from this record"));
}

/// Columns scaled to unit length; the weakest first, without what is unobservable.
void list_weak(const Question& question, Identifiability& result) {
  const auto& [R, names, s, noise_factor] = question;
  VectorXd lengths = R.colwise().norm();
  for (double& length : lengths) length = length > 0 ? length : 1.0;
  const Eigen::JacobiSVD<MatrixXd> unit(R * lengths.cwiseInverse().asDiagonal(),
                                        Eigen::ComputeFullV);
  for (Index i = R.cols() - 1; i >= 0; --i) {
    const double value = unit.singularValues()[i];
    if (value > weak_singular_value * unit.singularValues()[0]) continue;
    if (!(value > singular_floor * unit.singularValues()[0])) continue;
    const VectorXd v = unit.matrixV().col(i);
    const VectorXd shift = v.cwiseQuotient(lengths) * (noise_factor / value);
    if (shift.cwiseQuotient(s).norm() > 1.0) continue;  // listed as unobservable already
    // The main parts of c = sum v_k |column_k| xi_k; se(c) = |R^-T c|.
    std::vector<Index> involved = participants(v, share_to_be_inflated);
    std::erase_if(involved, [&](Index k) {
      if (std::abs(v[k]) >= share_to_be_weak_together * v.cwiseAbs().maxCoeff()) return false;
      // Belsley's share of the parameter's variance that this direction makes.
      const VectorXd parts =
          unit.matrixV().row(k).transpose().cwiseQuotient(unit.singularValues()).cwiseAbs2();
      return parts[i] < 0.5 * parts.sum();
    });
    const VectorXd functional = only(v.cwiseProduct(lengths), involved).normalized();
    const VectorXd deviation = R.triangularView<Eigen::Upper>().transpose().solve(functional);
    Combination weak{names_of(involved, names), combination_text(functional, names),
                     noise_factor * deviation.norm()};
    result.sentences.push_back(base::one_sentence(
        spoken_list(weak.parameters, most_names) + " are hard to tell apart: " + weak.text +
        " has a standard error of " + base::short_number(weak.standard_error)));
    result.weak.push_back(std::move(weak));
  }
}

}  // namespace

std::string combination_text(const VectorXd& coefficients, const std::vector<std::string>& names) {
  VectorXd c = coefficients / coefficients.norm();
  const double limit = share_to_be_written * c.cwiseAbs().maxCoeff();
  std::string text;
  double sign = 0.0;
  for (Index k = 0; k < c.size(); ++k) {
    if (!(std::abs(c[k]) > limit)) continue;
    if (sign == 0.0) sign = c[k] < 0 ? -1.0 : 1.0;  // the first coefficient is written positive
    const double value = sign * c[k];
    if (!text.empty()) text += value < 0 ? " - " : " + ";
    const std::string size = base::short_number(std::abs(value));
    if (size != "1") text += size + " ";
    text += names[static_cast<std::size_t>(k)];
  }
  return text;
}

MatrixXd sparsify(const MatrixXd& basis) {
  MatrixXd v = basis;
  std::vector<bool> reduced(static_cast<std::size_t>(v.cols()), false);
  for (Index step = 0; step < v.cols(); ++step) {
    Index row = 0;
    Index column = -1;
    double largest = 0.0;
    for (Index j = 0; j < v.cols(); ++j) {
      if (reduced[static_cast<std::size_t>(j)]) continue;
      Index at = 0;
      const double size = v.col(j).cwiseAbs().maxCoeff(&at);
      if (size > largest) {
        largest = size;
        row = at;
        column = j;
      }
    }
    if (column < 0) break;
    reduced[static_cast<std::size_t>(column)] = true;
    v.col(column) /= v(row, column);
    for (Index j = 0; j < v.cols(); ++j) {
      if (j != column) v.col(j) -= v(row, j) * v.col(column);
    }
  }
  v.colwise().normalize();
  return v;
}

Identifiability identify(const MatrixXd& R, const std::vector<std::string>& names,
                         const VectorXd& scale, double noise_factor) {
  Identifiability result;
  if (R.cols() == 0) return result;
  const Question question{R, names, usable(scale), noise_factor};
  list_unobservable(find_valleys(question, result.rank), names, result);
  list_weak(question, result);
  return result;
}

bool leaves_open(const MatrixXd& R, const VectorXd& scale) {
  if (R.cols() == 0) return false;
  const Eigen::JacobiSVD<MatrixXd> svd(R * usable(scale).asDiagonal());
  return svd.singularValues().minCoeff() < 1.0;
}

std::string Identifiability::message() const {
  std::vector<std::string> spoken = sentences;
  spoken.resize(within(most_sentences, sentences.size()));
  if (const std::size_t others = sentences.size() - spoken.size()) {
    spoken.push_back("and " + std::to_string(others) + " more (see unobservable and weak)");
  }
  return base::join_sentences(spoken);
}

}  // namespace sepcal
