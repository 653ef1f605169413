// SPDX-License-Identifier: BSD-3-Clause
#include "effects/composed_rows.hpp"

namespace sepcal::effects {
namespace {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::Ref;
using Eigen::VectorXd;

/// rows += diag(factor) part, the factor (one a sample) repeated for every output.
template <class Part>
void add_scaled(const VectorXd& factor, const Part& part, Ref<MatrixXd> rows) {
  for (Index first = 0; first < rows.rows(); first += factor.size()) {
    rows.middleRows(first, factor.size()) +=
        factor.asDiagonal() * part.middleRows(first, factor.size());
  }
}

}  // namespace

ComposedRows::ComposedRows(const BlockModel& model, const Tables& tables,
                           const ComposedParts& parts, const Block& block, const double* xi2,
                           const double* xi1, const std::vector<InputColumn>& columns)
    : model_(model),
      tables_(tables),
      parts_(parts),
      block_(block),
      xi2_(xi2),
      xi1_(xi1),
      columns_(columns),
      rows_(static_cast<Index>(block.rows)) {
  for (const VaryingPart& part : parts.varying) {
    drives_.push_back(drive(part));
    if (xi1 != nullptr) note_drift(part, drives_.back());
  }
}

ComposedRows::Drive ComposedRows::drive(const VaryingPart& part) const {
  const int functions = part.driver->functions();
  Drive result{MatrixXd(rows_, functions), {}};
  const bool sloped = part.shape >= 0 && xi1_ != nullptr;
  if (sloped) result.slopes.resize(rows_, functions);
  const auto input = static_cast<std::size_t>(part.driver_input);
  part.driver->evaluate(part.driver_input < 0 ? nullptr : block_.inputs[input], block_.first,
                        part.shape < 0 ? 0.0 : xi2_[part.shape], result.values,
                        sloped ? &result.slopes : nullptr);
  return result;
}

void ComposedRows::note_drift(const VaryingPart& part, const Drive& drive) {
  Index column = part.first;
  for (const int target : part.targets) {
    const Map<const VectorXd> s(xi1_ + column, drive.values.cols());
    column += drive.values.cols();
    if (target < 0) continue;
    VectorXd& drift = drifts_[target];
    if (drift.size() == 0) drift = VectorXd::Zero(rows_);
    drift.noalias() += drive.values * s;
  }
}

std::vector<const double*> ComposedRows::select(const std::vector<int>& inputs) const {
  std::vector<const double*> pointers;
  pointers.reserve(inputs.size());
  for (const int i : inputs) pointers.push_back(columns_[static_cast<std::size_t>(i)].values);
  return pointers;
}

Block ComposedRows::with(const std::vector<const double*>& inputs) const {
  return {inputs, block_.rows, block_.first, block_.starts_segment};
}

/// What a component scales: outputs and where their values begin. A: the model's own (or wider).
std::vector<std::pair<Index, const double*>> ComposedRows::bases(
    const VaryingPart& part, std::size_t component, const Ref<const MatrixXd>& A) const {
  std::vector<std::pair<Index, const double*>> result;
  if (part.targets[component] < 0) {
    for (const auto& [output, input] : part.shares[component]) {
      result.emplace_back(output, columns_[static_cast<std::size_t>(input)].values);
    }
    return result;
  }
  for (Index j = 0; j < tables_.n_z(); ++j)
    result.emplace_back(j, A.col(part.targets[component]).data() + j * rows_);
  return result;
}

/// The model's xi1 with one parameter greater by one.
VectorXd ComposedRows::step(int target) const {
  VectorXd stepped = Map<const VectorXd>(xi1_, model_.tables().n_1());
  stepped[target] += 1.0;
  return stepped;
}

// NOLINTNEXTLINE(performance-unnecessary-value-param): an output
void ComposedRows::fill(Ref<MatrixXd> rows, Carry* carry, const CarryOf& stepped) const {
  fill_own(rows, carry);
  for (std::size_t i = 0; i < parts_.varying.size(); ++i) {
    fill_varying(parts_.varying[i], drives_[i], rows);
  }
  for (const TermPart& part : parts_.terms) fill_term(part, rows);
  if (xi1_ != nullptr && model_.tables().n_2() > 0 && !drifts_.empty()) {
    add_drift_to_tangent(rows, stepped);
  }
}

/// The model writes its [A | D | b] at the left; D and b then move to their places.
void ComposedRows::fill_own(Ref<MatrixXd> rows, Carry* carry) const {
  const Index own_1 = model_.tables().n_1();
  const Index own_2 = xi1_ == nullptr ? 0 : model_.tables().n_2();
  const Index n_1 = tables_.n_1();
  const std::vector<const double*> inputs = select(parts_.model_inputs);
  model_.evaluate(with(inputs), xi2_, xi1_, carry, rows.leftCols(own_1 + own_2 + 1));
  const Index last = rows.cols() - 1;
  if (last == own_1 + own_2) return;
  rows.col(last) = rows.col(own_1 + own_2);
  for (Index k = own_2 - 1; k >= 0 && n_1 > own_1; --k) rows.col(n_1 + k) = rows.col(own_1 + k);
  rows.middleCols(own_1, n_1 - own_1).setZero();
  rows.middleCols(n_1 + own_2, last - n_1 - own_2).setZero();
}

void ComposedRows::fill_varying(const VaryingPart& part, const Drive& drive,
                                Ref<MatrixXd> rows) const {
  Index column = part.first;
  for (std::size_t c = 0; c < part.targets.size(); ++c) {
    const auto scaled = bases(part, c, rows);
    for (Index j = 0; j < drive.values.cols(); ++j, ++column) {
      for (const auto& [output, values] : scaled) {
        const Map<const VectorXd> base(values, rows_);
        rows.col(column).segment(output * rows_, rows_) += base.cwiseProduct(drive.values.col(j));
        if (drive.slopes.cols() == 0) continue;
        rows.col(tables_.n_1() + part.shape).segment(output * rows_, rows_) +=
            xi1_[column] * base.cwiseProduct(drive.slopes.col(j));
      }
    }
  }
}

void ComposedRows::fill_term(const TermPart& part, Ref<MatrixXd> rows) const {
  const Index own_1 = part.model->tables().n_1();
  const Index own_2 = xi1_ == nullptr ? 0 : part.model->tables().n_2();
  const std::vector<const double*> inputs = select(part.inputs);
  MatrixXd own(rows.rows(), own_1 + own_2 + 1);
  part.model->evaluate(with(inputs), xi2_ + part.first_nonlinear,
                       xi1_ == nullptr ? nullptr : xi1_ + part.first_linear, nullptr, own);
  rows.middleCols(part.first_linear, own_1) = own.leftCols(own_1);
  if (own_2 > 0) {
    rows.middleCols(tables_.n_1() + part.first_nonlinear, own_2) = own.middleCols(own_1, own_2);
  }
  rows.rightCols<1>() += own.rightCols<1>();
}

// NOLINTNEXTLINE(performance-unnecessary-value-param): an output
void ComposedRows::add_drift_to_tangent(Ref<MatrixXd> rows, const CarryOf& stepped) const {
  const Index own_1 = model_.tables().n_1();
  const Index own_2 = model_.tables().n_2();
  const std::vector<const double*> inputs = select(parts_.model_inputs);
  const MatrixXd here = rows.middleCols(tables_.n_1(), own_2);
  MatrixXd ahead(rows.rows(), own_1 + own_2 + 1);
  for (const auto& [target, drift] : drifts_) {
    const VectorXd there = step(target);
    model_.evaluate(with(inputs), xi2_, there.data(), stepped(target), ahead);
    add_scaled(drift, ahead.middleCols(own_1, own_2) - here, rows.middleCols(tables_.n_1(), own_2));
  }
}

/// Which of a part's inputs have slopes.
std::vector<int> ComposedRows::find_moving(const std::vector<int>& inputs) const {
  std::vector<int> moving;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (columns_[static_cast<std::size_t>(inputs[i])].slopes.cols() == 0) continue;
    moving.push_back(static_cast<int>(i));
  }
  return moving;
}

/// by_input: derivatives with respect to the moving inputs (n_z * rows x moving).
void ComposedRows::add_chain(const MatrixXd& by_input, const std::vector<int>& inputs,
                             const std::vector<int>& moving, Ref<MatrixXd> slopes) const {
  for (std::size_t m = 0; m < moving.size(); ++m) {
    const auto index = static_cast<std::size_t>(inputs[static_cast<std::size_t>(moving[m])]);
    for (Index first = 0; first < slopes.rows(); first += rows_) {
      slopes.middleRows(first, rows_) +=
          by_input.col(static_cast<Index>(m)).segment(first, rows_).asDiagonal() *
          columns_[index].slopes;
    }
  }
}

// NOLINTNEXTLINE(performance-unnecessary-value-param): an output
void ComposedRows::add_slopes(Ref<MatrixXd> slopes) const {
  const std::vector<int> moving = find_moving(parts_.model_inputs);
  if (!moving.empty()) {
    const std::vector<const double*> inputs = select(parts_.model_inputs);
    MatrixXd here(slopes.rows(), static_cast<Index>(moving.size()));
    model_.input_tangent(with(inputs), xi2_, xi1_, moving, here);
    MatrixXd by_input = here;
    MatrixXd ahead(here.rows(), here.cols());
    for (const auto& [target, drift] : drifts_) {
      const VectorXd stepped = step(target);
      model_.input_tangent(with(inputs), xi2_, stepped.data(), moving, ahead);
      add_scaled(drift, ahead - here, by_input);
    }
    add_chain(by_input, parts_.model_inputs, moving, slopes);
  }
  for (std::size_t i = 0; i < parts_.varying.size(); ++i) {
    add_slopes(parts_.varying[i], drives_[i], slopes);
  }
  for (const TermPart& part : parts_.terms) {
    const std::vector<int> moving_here = find_moving(part.inputs);
    if (moving_here.empty()) continue;
    const std::vector<const double*> inputs = select(part.inputs);
    MatrixXd by_input(slopes.rows(), static_cast<Index>(moving_here.size()));
    part.model->input_tangent(with(inputs), xi2_ + part.first_nonlinear, xi1_ + part.first_linear,
                              moving_here, by_input);
    add_chain(by_input, part.inputs, moving_here, slopes);
  }
}

void ComposedRows::add_slopes(const VaryingPart& part, const Drive& drive,
                              Ref<MatrixXd> slopes) const {
  const Index functions = drive.values.cols();
  for (std::size_t c = 0; c < part.targets.size(); ++c) {
    if (part.shares[c].empty()) continue;
    const Map<const VectorXd> s(xi1_ + part.first + static_cast<Index>(c) * functions, functions);
    const VectorXd share = drive.values * s;
    for (const auto& [output, input] : part.shares[c]) {
      const MatrixXd& moving = columns_[static_cast<std::size_t>(input)].slopes;
      if (moving.cols() == 0) continue;
      slopes.middleRows(output * rows_, rows_) += share.asDiagonal() * moving;
    }
  }
}

}  // namespace sepcal::effects
