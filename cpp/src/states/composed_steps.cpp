// SPDX-License-Identifier: BSD-3-Clause
#include "states/composed_steps.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sepcal::states {

using effects::TermPart;
using effects::VaryingPart;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

ComposedSteps::ComposedSteps(const ComposedTrajectory& model, const Record& record,
                             const VectorXd& xi)
    : model_(model), record_(record) {
  ComposedSteps::set_parameters(xi);
}

void ComposedSteps::set_parameters(const VectorXd& xi) {
  move_to(xi);
  const std::vector<MovingParameter>& moving = model_.moving();
  beside_.resize(moving.size());
  for (std::size_t k = 0; k < moving.size(); ++k) {
    for (std::size_t i = 0; i < difference_nodes.size(); ++i) {
      auto& steps = beside_[k][i];
      if (!steps) steps.reset(new ComposedSteps(model_, record_));
      VectorXd moved = xi;
      moved[model_.tables().n_1() + moving[k].place] += difference_nodes[i].node * moving[k].step;
      steps->move_to(moved);
    }
  }
}

void ComposedSteps::move_to(const VectorXd& xi) {
  const Index n_2 = model_.tables().n_2();
  const bool same_inputs = own_ && xi_.tail(n_2) == xi.tail(n_2);
  xi_ = xi;
  if (same_inputs) return own_->set_parameters(own_parameters());
  const VectorXd xi2 = xi.tail(n_2);
  auto corrected = std::make_unique<const Record>(model_.correct(record_, values_of(xi2)));
  own_ = model_.model().steps(*corrected, own_parameters());
  corrected_ = std::move(corrected);  // now that nothing reads the one before
  drives_.clear();
  terms_.clear();
  for (const VaryingPart& part : model_.parts().varying) drives_.push_back(drive(part));
  for (const TermPart& part : model_.parts().terms) terms_.push_back(evaluate(part));
}

VectorXd ComposedSteps::own_parameters() const { return xi_(own_columns()); }

MatrixXd ComposedSteps::drift() const {
  MatrixXd drift;
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    const VaryingPart& part = model_.parts().varying[i];
    const Index functions = drives_[i].values.cols();
    for (std::size_t c = 0; c < part.targets.size(); ++c) {
      if (part.targets[c] < 0) continue;
      if (drift.size() == 0) {
        drift = MatrixXd::Zero(drives_[i].values.rows(), model_.model().tables().n_1());
      }
      drift.col(part.targets[c]) +=
          drives_[i].values *
          xi_.segment(part.first + static_cast<Index>(c) * functions, functions);
    }
  }
  return drift;
}

/// Where the model's own parameters stand among all.
std::vector<Index> ComposedSteps::own_columns() const {
  const Tables& own = model_.model().tables();
  std::vector<Index> columns;
  for (Index k = 0; k < own.n_1(); ++k) columns.push_back(k);
  for (Index k = 0; k < own.n_2(); ++k) columns.push_back(model_.tables().n_1() + k);
  return columns;
}

/// The same of those that act on steps and outputs.
std::vector<Index> ComposedSteps::own_acting() const {
  const std::vector<Index> columns = own_columns();
  std::vector<Index> places;
  for (const int column : model_.model().plan().acting_columns()) {
    places.push_back(acting_place(columns[static_cast<std::size_t>(column)]));
  }
  return places;
}

Index ComposedSteps::acting_place(Index parameter) const {
  const std::vector<int>& acting = model_.plan().acting_columns();
  return std::ranges::find(acting, static_cast<int>(parameter)) - acting.begin();
}

ComposedSteps::Drive ComposedSteps::drive(const VaryingPart& part) const {
  const auto length = static_cast<Index>(record_.length());
  const Index functions = part.driver->functions();
  const bool shaped = part.shape >= 0;
  Drive drive{MatrixXd::Zero(length, functions), {}};
  if (shaped) drive.slopes = MatrixXd::Zero(length, functions);
  for (const Segment& segment : record_.segments()) {
    const auto first = static_cast<Index>(segment.first);
    const auto rows = static_cast<Index>(segment.rows());
    const double* d = nullptr;
    if (part.driver->input()) {
      d = record_.column(part.driver->input()->name).data() + segment.first;
    }
    MatrixXd slopes(shaped ? rows : 0, functions);
    part.driver->evaluate(d, segment.first, shaped ? xi_[model_.tables().n_1() + part.shape] : 0.0,
                          drive.values.middleRows(first, rows), shaped ? &slopes : nullptr);
    if (shaped) drive.slopes.middleRows(first, rows) = slopes;
  }
  return drive;
}

/// An input as the model sees it, or as it was logged where the model has none of that name.
std::span<const double> ComposedSteps::input(int place) const {
  const Variable& variable = model_.tables().inputs[static_cast<std::size_t>(place)];
  return (corrected_->has(variable.name) ? *corrected_ : record_).column(variable.name);
}

double ComposedSteps::input_at(int place, std::size_t row) const {
  const Variable& variable = model_.tables().inputs[static_cast<std::size_t>(place)];
  const bool is_there = corrected_->has(variable.name) || record_.has(variable.name);
  return is_there || !std::isfinite(variable.absent) ? input(place)[row] : variable.absent;
}

MatrixXd ComposedSteps::evaluate(const TermPart& part) const {
  const Tables& own = part.model->tables();
  const auto length = static_cast<Index>(record_.length());
  MatrixXd whole = MatrixXd::Zero(n_z() * length, own.n_1() + own.n_2() + 1);
  const VectorXd xi1 = xi_.segment(part.first_linear, own.n_1());
  const VectorXd xi2 = xi_.segment(model_.tables().n_1() + part.first_nonlinear, own.n_2());
  for (const Segment& segment : record_.segments()) {
    std::vector<const double*> inputs;
    for (const int place : part.inputs) inputs.push_back(input(place).data() + segment.first);
    const auto rows = static_cast<Index>(segment.rows());
    MatrixXd filled(n_z() * rows, whole.cols());
    part.model->evaluate({inputs, segment.rows(), segment.first, true}, values_of(xi2),
                         values_of(xi1), nullptr, filled);
    for (Index j = 0; j < n_z(); ++j) {
      whole.middleRows(j * length + static_cast<Index>(segment.first), rows) =
          filled.middleRows(j * rows, rows);
    }
  }
  return whole;
}

std::vector<ComposedSteps::Column> ComposedSteps::columns_at(std::size_t row) const {
  const int n_1 = model_.tables().n_1();
  const auto at = static_cast<Index>(row);
  std::vector<Column> columns;
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    const VaryingPart& part = model_.parts().varying[i];
    int column = part.first;
    for (std::size_t c = 0; c < part.targets.size(); ++c) {
      VectorXd shared = VectorXd::Zero(n_z());
      for (const auto& [output, source] : part.shares[c]) shared[output] += input_at(source, row);
      for (Index f = 0; f < drives_[i].values.cols(); ++f, ++column) {
        const double phi = drives_[i].values(at, f);
        columns.push_back({column, part.targets[c], phi, phi * shared});
        if (part.shape < 0) continue;
        const double slope = xi_[column] * drives_[i].slopes(at, f);
        columns.push_back({n_1 + part.shape, part.targets[c], slope, slope * shared});
      }
    }
  }
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    const TermPart& part = model_.parts().terms[i];
    const int own_1 = part.model->tables().n_1();
    const MatrixXd rows =
        terms_[i](Eigen::seqN(at, n_z(), static_cast<Index>(record_.length())), Eigen::all);
    for (int k = 0; k < rows.cols() - 1; ++k) {
      const int parameter =
          k < own_1 ? part.first_linear + k : n_1 + part.first_nonlinear + k - own_1;
      columns.push_back({parameter, -1, 0.0, rows.col(k)});
    }
  }
  return columns;
}

/// Moves the model's own linear parameters to what they are in this row. Returns what the effects
/// add to the outputs beside them (n_z).
VectorXd ComposedSteps::read_effects(std::size_t row, const std::vector<Column>& columns) const {
  VectorXd own = own_parameters();
  VectorXd added = VectorXd::Zero(n_z());
  bool drifts = false;
  for (const Column& column : columns) {
    if (column.parameter >= model_.tables().n_1()) continue;
    const double size = xi_[column.parameter];
    if (column.target >= 0) {
      own[column.target] += size * column.share;
      drifts = true;
    } else {
      added += size * column.own;
    }
  }
  for (const MatrixXd& term : terms_) {
    added += term.rightCols<1>()(
        Eigen::seqN(static_cast<Index>(row), n_z(), static_cast<Index>(record_.length())));
  }
  if (drifts) own_->set_parameters(own);
  return added;
}

/// The derivative of what `give` takes from the steps beside.
template <class Give>
VectorXd ComposedSteps::difference(std::size_t moving, const Give& give) const {
  VectorXd slope;
  for (std::size_t i = 0; i < difference_nodes.size(); ++i) {
    const VectorXd there = give(*beside_[moving][i]);
    const VectorXd share = difference_nodes[i].weight / model_.moving()[moving].step * there;
    slope = i == 0 ? share : VectorXd(slope + share);
  }
  return slope;
}

StateSteps::Step ComposedSteps::advance(std::size_t row, const VectorXd& x) const {
  return own_->advance(row, x);
}

VectorXd ComposedSteps::next(std::size_t row, const VectorXd& x) const {
  return own_->next(row, x);
}

MatrixXd ComposedSteps::rate_slopes(std::size_t row, const VectorXd& x) const {
  return own_->rate_slopes(row, x);
}

StateSteps::Reading ComposedSteps::read(std::size_t row, const VectorXd& x) const {
  const VectorXd added = read_effects(row, columns_at(row));
  Reading reading = own_->read(row, x);
  reading.z += added;
  return reading;
}

VectorXd ComposedSteps::expect(std::size_t row, const VectorXd& x) const {
  const VectorXd added = read_effects(row, columns_at(row));
  return own_->expect(row, x) + added;
}

StateSteps::JointStep ComposedSteps::advance_jointly(std::size_t row, const VectorXd& x,
                                                     const VectorXd& density) const {
  JointStep joint = own_->advance_jointly(row, x, density);
  MatrixXd Phi = MatrixXd::Zero(n_x(), n_x() + xi_.size());
  Phi.leftCols(n_x()) = joint.Phi.leftCols(n_x());
  auto by_parameters = Phi.rightCols(xi_.size());
  by_parameters(Eigen::all, own_columns()) = joint.Phi.rightCols(joint.Phi.cols() - n_x());
  for (std::size_t k = 0; k < beside_.size(); ++k) {
    by_parameters.col(model_.tables().n_1() + model_.moving()[k].place) =
        difference(k, [&](const ComposedSteps& steps) { return steps.next(row, x); });
  }
  joint.Phi = std::move(Phi);
  return joint;
}

StateSteps::Reading ComposedSteps::read_jointly(std::size_t row, const VectorXd& x) const {
  const std::vector<Column> columns = columns_at(row);
  const VectorXd added = read_effects(row, columns);
  Reading own = own_->read_jointly(row, x);
  Reading reading{own.z + added, MatrixXd::Zero(n_z(), n_x() + xi_.size())};
  reading.H.leftCols(n_x()) = own.H.leftCols(n_x());
  auto by_parameters = reading.H.rightCols(xi_.size());
  by_parameters(Eigen::all, own_columns()) = own.H.rightCols(own.H.cols() - n_x());
  for (const Column& column : columns) {
    auto to = by_parameters.col(column.parameter);
    if (column.target < 0) {
      to += column.own;
    } else {
      to += column.share * own.H.col(n_x() + column.target);
    }
  }
  for (std::size_t k = 0; k < beside_.size(); ++k) {
    by_parameters.col(model_.tables().n_1() + model_.moving()[k].place) =
        difference(k, [&](const ComposedSteps& steps) { return steps.expect(row, x); });
  }
  return reading;
}

StateSteps::SecondOrderStep ComposedSteps::advance_to_second_order(std::size_t row,
                                                                   const VectorXd& x) const {
  const SecondOrderStep own = own_->advance_to_second_order(row, x);
  const std::vector<Index> places = own_acting();
  const auto acting = static_cast<Index>(model_.plan().acting_columns().size());
  const auto widen = [&](const MatrixXd& slopes) {
    MatrixXd wide = MatrixXd::Zero(n_x() + acting, slopes.cols());
    wide.topRows(n_x()) = slopes.topRows(n_x());
    wide.bottomRows(acting)(places, Eigen::all) = slopes.bottomRows(slopes.rows() - n_x());
    return wide;
  };
  SecondOrderStep step{.x = own.x,
                       .Phi = own.Phi,
                       .Pi = MatrixXd::Zero(n_x(), acting),
                       .Gamma = own.Gamma,
                       .Phi_slopes = widen(own.Phi_slopes),
                       .Gamma_slopes = widen(own.Gamma_slopes)};
  step.Pi(Eigen::all, places) = own.Pi;
  for (std::size_t k = 0; k < beside_.size(); ++k) {
    const Index place = acting_place(model_.tables().n_1() + model_.moving()[k].place);
    const VectorXd slopes = difference(k, [&](const ComposedSteps& steps) {
      const Step there = steps.advance(row, x);
      VectorXd all(there.x.size() + there.Phi.size() + there.Gamma.size());
      all << there.x, there.Phi.reshaped(), there.Gamma.reshaped();
      return all;
    });
    step.Pi.col(place) = slopes.head(n_x());
    step.Phi_slopes.row(n_x() + place) = slopes.segment(n_x(), own.Phi.size()).transpose();
    step.Gamma_slopes.row(n_x() + place) = slopes.tail(own.Gamma.size()).transpose();
  }
  return step;
}

StateSteps::SecondOrderReading ComposedSteps::read_to_second_order(std::size_t row,
                                                                   const VectorXd& x) const {
  const std::vector<Column> columns = columns_at(row);
  const VectorXd added = read_effects(row, columns);
  const SecondOrderReading own = own_->read_to_second_order(row, x);
  const std::vector<Index> places = own_acting();
  const auto acting = static_cast<Index>(model_.plan().acting_columns().size());
  SecondOrderReading reading{.z = own.z + added,
                             .H = own.H,
                             .J = MatrixXd::Zero(n_z(), acting),
                             .H_slopes = MatrixXd::Zero(n_x() + acting, own.H.size())};
  reading.J(Eigen::all, places) = own.J;
  reading.H_slopes.topRows(n_x()) = own.H_slopes.topRows(n_x());
  auto curvatures = reading.H_slopes.bottomRows(acting);
  curvatures(places, Eigen::all) = own.H_slopes.bottomRows(own.J.cols());
  for (const Column& column : columns) {
    const Index place = acting_place(column.parameter);
    if (column.target < 0) {
      reading.J.col(place) += column.own;
      continue;
    }
    const Index target = acting_place(column.target);
    reading.J.col(place) += column.share * reading.J.col(target);
    curvatures.row(place) += column.share * curvatures.row(target);
  }
  for (std::size_t k = 0; k < beside_.size(); ++k) {
    const Index place = acting_place(model_.tables().n_1() + model_.moving()[k].place);
    const VectorXd slopes = difference(k, [&](const ComposedSteps& steps) {
      const Reading there = steps.read(row, x);
      VectorXd all(there.z.size() + there.H.size());
      all << there.z, there.H.reshaped();
      return all;
    });
    reading.J.col(place) = slopes.head(n_z());
    curvatures.row(place) = slopes.tail(own.H.size()).transpose();
  }
  return reading;
}

}  // namespace sepcal::states
