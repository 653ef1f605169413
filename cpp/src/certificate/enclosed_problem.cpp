// SPDX-License-Identifier: BSD-3-Clause
#include "certificate/enclosed_problem.hpp"

#include <algorithm>

#include "sepcal/error.hpp"

namespace sepcal::certificate {

using Eigen::Index;
using Eigen::VectorXd;

Ranges points(const VectorXd& x) {
  Ranges ranges;
  for (const double value : x) ranges.emplace_back(value);
  return ranges;
}

EnclosedProblem::EnclosedProblem(const BlockModel& model, const Record& record,
                                 const VectorXd& sigma)
    : model_(model), measurements_(model, record) {
  for (const auto& chunk : measurements_.chunks()) {
    for (const auto& range : chunk) {
      for (int j = 0; j < model.tables().n_z(); ++j) {
        const auto z = measurements_.output(j, range);
        z_.insert(z_.end(), z.begin(), z.end());
        weights_.insert(weights_.end(), z.size(), 1.0 / sigma[j]);
      }
    }
  }
  over(points(VectorXd::Zero(n_2())));
}

EnclosedRows EnclosedProblem::over(const Ranges& xi2) const {
  EnclosedRows all;
  EnclosedRows part;
  std::vector<const double*> pointers;
  for (const auto& chunk : measurements_.chunks()) {
    for (const auto& range : chunk) {
      if (!model_.enclose(measurements_.block(range, pointers), xi2, part)) {
        throw Error(
            "this model can't be enclosed, so nothing is proven of it: one of your own says "
            "'static constexpr bool enclosed = true' where at() takes an EnclosedDual");
      }
      if (all.parts.empty()) {
        all.columns = part.columns;
        all.n_2 = part.n_2;
        all.parts.reserve(z_.size() * static_cast<std::size_t>(part.columns) *
                          static_cast<std::size_t>(EnclosedRows::parts_of(part.n_2)));
      }
      all.parts.insert(all.parts.end(), part.parts.begin(), part.parts.end());
    }
  }
  return all;
}

Enclosure EnclosedProblem::cost(const VectorXd& xi1, const VectorXd& xi2) const {
  const EnclosedRows at = over(points(xi2));
  Enclosure sum(0.0);
  for (Index i = 0; i < rows(); ++i) {
    Enclosure residual = Enclosure(z(i)) - *at.at(i, n_1());
    for (Index l = 0; l < n_1(); ++l) residual = residual - *at.at(i, l) * xi1[l];
    sum += square(residual * weight(i));
  }
  return sum * 0.5;
}

}  // namespace sepcal::certificate
