// SPDX-License-Identifier: BSD-3-Clause
#include "diagnosis/known_products.hpp"

#include <memory>
#include <mutex>
#include <utility>

#include "numerics/tall_products.hpp"

namespace sepcal::diagnosis {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using noise::LaggedSquares;
using noise::NoiseFamilies;
using noise::NoiseFamily;
using noise::NoiseMember;

/// What is known of one output, found where it is first asked for.
struct KnownProducts::Output {
  template <class Value>
  struct Once {
    std::once_flag made = {};
    Value value = {};
  };

  Output(std::size_t fractions, std::size_t gauss_markovs)
      : fractional(fractions), gauss_markov(gauss_markovs) {}

  std::vector<Once<std::unique_ptr<const LaggedSquares>>> fractional;  // of each d
  std::vector<Once<MatrixXd>> gauss_markov;  // of each member with sigma 1
};

KnownProducts::KnownProducts(const NoiseFamilies& families, const RowLayout& layout,
                             const Columns& B, const VectorXd& e, std::vector<int> orders)
    : families_(families), layout_(layout), known_(join(B, view(e))), orders_(std::move(orders)) {
  for (std::size_t j = 0; j < orders_.size(); ++j) {
    outputs_.push_back(std::make_unique<Output>(families.fractions(), families.gauss_markovs()));
  }
}

KnownProducts::~KnownProducts() = default;

MatrixXd KnownProducts::known_rows(std::size_t j) const {
  return known_.rows(layout_.first(j), layout_.rows);
}

MatrixXd KnownProducts::whitened_square(const NoiseMember& member, std::size_t j) const {
  MatrixXd white = known_rows(j);
  families_.whiten(member, white);
  MatrixXd square = MatrixXd::Zero(white.cols(), white.cols());
  numerics::add_square(white, square);
  return square;
}

MatrixXd KnownProducts::known_square(const NoiseMember& member, std::size_t j) const {
  const double variance = member.sigma * member.sigma;
  if (member.family == NoiseFamily::gauss_markov) {
    auto& known = outputs_[j]->gauss_markov[member.at];
    std::call_once(known.made, [&] {
      NoiseMember unit = member;
      unit.sigma = 1.0;
      known.value = whitened_square(unit, j);
    });
    return known.value / variance;
  }
  auto& known = outputs_[j]->fractional[member.at];
  std::call_once(known.made, [&] {
    known.value = std::make_unique<const LaggedSquares>(
        families_.lagged_squares(member.at, known_rows(j), orders_[j]));
  });
  const MatrixXd square = known.value->whitened(member.partial);
  return known.value->is_sound(square) ? square / variance : whitened_square(member, j);
}

MatrixXd KnownProducts::beside(const NoiseMembers& noise, const Columns& X) const {
  const Index more = X.cols();
  const Index known = known_.cols();
  MatrixXd squares = MatrixXd::Zero(known, known);
  MatrixXd shares = MatrixXd::Zero(known, more);
  MatrixXd own = MatrixXd::Zero(more, more);
  for (std::size_t j = 0; j < noise.size(); ++j) {
    squares += known_square(noise[j], j);
    if (more == 0) continue;
    MatrixXd rows = X.rows(layout_.first(j), layout_.rows);
    families_.whiten(noise[j], rows);
    numerics::add_square(rows, own);
    for (auto column : rows.colwise()) families_.whiten_backwards(noise[j], column);
    for (Index row = 0; row < layout_.rows; row += panel_rows) {
      const auto panel = rows.middleRows(row, std::min(panel_rows, layout_.rows - row));
      known_.visit(layout_.first(j) + row, panel.rows(), [&](Index at, const Columns::Rows& part) {
        numerics::add_transposed_product(part, panel, shares.middleRows(at, part.cols()));
      });
    }
  }
  const Index p = known - 1;
  const Index last = p + more;
  MatrixXd products(last + 1, last + 1);
  products.topLeftCorner(p, p) = squares.topLeftCorner(p, p);
  products.block(0, p, p, more) = shares.topRows(p);
  products.block(p, p, more, more) = own;
  products.col(last).head(p) = squares.col(p).head(p);
  products.col(last).segment(p, more) = shares.row(p).transpose();
  products(last, last) = squares(p, p);
  return products.selfadjointView<Eigen::Upper>();
}

}  // namespace sepcal::diagnosis
