// SPDX-License-Identifier: BSD-3-Clause
#include "states/composed_trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "effects/composed_rows.hpp"
#include "effects/composed_tables.hpp"
#include "sepcal/error.hpp"
#include "states/composed_steps.hpp"
#include "states/path_tangent.hpp"

namespace sepcal::states {

using effects::ComposedRows;
using effects::InputColumn;
using effects::LagNode;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Ref;
using Eigen::VectorXd;

namespace {

/// The columns of a table's inputs over a segment; `constants` holds those that the record lacks.
std::vector<const double*> columns_of(const Tables& tables, const Record& record,
                                      const Segment& segment,
                                      std::vector<std::vector<double>>& constants) {
  std::vector<const double*> inputs;
  for (const Variable& input : tables.inputs) {
    if (record.has(input.name) || !std::isfinite(input.absent)) {
      inputs.push_back(record.column(input.name).data() + segment.first);
    } else {
      inputs.push_back(constants.emplace_back(segment.rows(), input.absent).data());
    }
  }
  return inputs;
}

}  // namespace

/// Those of the model itself, of linear parameters that vary, and beside them.
struct ComposedTrajectory::Paths final : Carry {
  std::unique_ptr<Carry> own;
  std::map<int, std::unique_ptr<Carry>> stepped;  // by linear parameter, one greater there
  std::vector<std::unique_ptr<Carry>> beside;     // of each moving parameter its nodes
};

ComposedTrajectory::ComposedTrajectory(std::shared_ptr<const StateBlockModel> model,
                                       const std::vector<Effect>& effects, const Record& record)
    : StateBlockModel(effects::join_tables(*model, effects)),
      model_(std::move(model)),
      parts_(effects::find_parts(tables(), *model_, effects)),
      corrections_(tables(), parts_, record),
      plan_(model_->plan().with_effects(tables())) {
  for (const effects::VaryingPart& part : parts_.varying) {
    for (const int target : part.targets) {
      if (target < static_cast<int>(plan_.linear().size())) continue;
      throw Error("'" + tables().linear[static_cast<std::size_t>(target)].name +
                  "' is a parameter of the dynamics; only those of the outputs may vary");
    }
  }
  find_moving(effects, record);
}

std::unique_ptr<Carry> ComposedTrajectory::new_carry() const {
  auto paths = std::make_unique<Paths>();
  paths->own = model_->new_carry();
  for (const effects::VaryingPart& part : parts_.varying) {
    for (const int target : part.targets) {
      if (target >= 0) paths->stepped.emplace(target, model_->new_carry());
    }
  }
  for (std::size_t k = 0; k < moving_.size() * difference_nodes.size(); ++k) {
    paths->beside.push_back(model_->new_carry());
  }
  return paths;
}

void ComposedTrajectory::evaluate(const Block& block, const double* xi2, const double* xi1,
                                  Carry* carry, Ref<MatrixXd> rows) const {
  const auto& paths = static_cast<const Paths&>(*carry);
  const std::vector<InputColumn> columns = corrections_.correct(block, xi2, LagNode{}, 0);
  const ComposedRows composed(*model_, tables(), parts_, block, xi2, xi1, columns);
  composed.fill(rows, paths.own.get(), [&](int target) { return paths.stepped.at(target).get(); });
  if (xi1 == nullptr) return;
  VectorXd moved = Eigen::Map<const VectorXd>(xi2, tables().n_2());
  auto path = paths.beside.begin();
  for (const auto& [place, step] : moving_) {
    auto slope = rows.col(tables().n_1() + place);
    slope.setZero();
    for (const auto& [node, weight] : difference_nodes) {
      moved[place] = xi2[place] + node * step;
      slope += weight / step * total(block, moved, xi1, (path++)->get());
    }
    moved[place] = xi2[place];
  }
}

/// A xi1 + b.
VectorXd ComposedTrajectory::total(const Block& block, const VectorXd& xi2, const double* xi1,
                                   Carry* carry) const {
  const std::vector<InputColumn> columns = corrections_.correct(block, xi2.data(), LagNode{}, 0);
  MatrixXd rows(tables().n_z() * static_cast<Index>(block.rows), tables().n_1() + 1);
  ComposedRows(*model_, tables(), parts_, block, xi2.data(), nullptr, columns)
      .fill(rows, carry, [](int) { return nullptr; });
  const Eigen::Map<const VectorXd> linear(xi1, tables().n_1());
  return rows.leftCols(tables().n_1()) * linear + rows.rightCols<1>();
}

/// Calls visit(segment, input, column) for the model's inputs as corrections leave them, with
/// slopes by so many of xi2.
template <class Visit>
void ComposedTrajectory::visit_inputs(const Record& record, const double* xi2, int slopes,
                                      const Visit& visit) const {
  for (const Segment& segment : record.segments()) {
    std::vector<std::vector<double>> constants;
    const std::vector<const double*> inputs = columns_of(tables(), record, segment, constants);
    const Block block{inputs, segment.rows(), segment.first, true};
    const std::vector<InputColumn> columns = corrections_.correct(block, xi2, LagNode{}, slopes);
    for (std::size_t i = 0; i < model_->tables().inputs.size(); ++i) {
      visit(segment, i, columns[static_cast<std::size_t>(parts_.model_inputs[i])]);
    }
  }
}

Record ComposedTrajectory::correct(const Record& record, const double* xi2) const {
  std::map<std::string, std::vector<double>> changed;
  visit_inputs(
      record, xi2, 0, [&](const Segment& segment, std::size_t i, const InputColumn& column) {
        if (column.own.empty()) return;
        std::vector<double>& whole = changed[model_->tables().inputs[i].name];
        if (whole.empty()) whole.assign(record.length(), not_a_number);
        std::ranges::copy(column.own, whole.begin() + static_cast<std::ptrdiff_t>(segment.first));
      });
  Record corrected;
  for (const std::string& name : record.names()) {
    if (!changed.contains(name)) corrected.view(name, record.column(name));
  }
  for (auto& [name, values] : changed) corrected.add(name, std::move(values));
  corrected.cut(record.segments());
  return corrected;
}

std::vector<InputSlopes> ComposedTrajectory::input_slopes(const Record& record,
                                                          const VectorXd& xi2) const {
  const std::vector<Variable>& inputs = model_->tables().inputs;
  std::vector<MatrixXd> all(inputs.size());
  visit_inputs(record, values_of(xi2), tables().n_2(),
               [&](const Segment& segment, std::size_t i, const InputColumn& column) {
                 if (column.slopes.cols() == 0) return;
                 if (all[i].size() == 0) {
                   all[i] = MatrixXd::Constant(static_cast<Index>(record.length()), tables().n_2(),
                                               not_a_number);
                 }
                 all[i].middleRows(static_cast<Index>(segment.first),
                                   static_cast<Index>(segment.rows())) = column.slopes;
               });
  std::vector<InputSlopes> slopes;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    if (all[i].size() > 0) slopes.push_back({inputs[i].name, std::move(all[i])});
  }
  return slopes;
}

/// Those of corrections and delays. The time of a step has no slope: it is searched for.
void ComposedTrajectory::find_moving(const std::vector<Effect>& effects, const Record& record) {
  std::vector<int> places;
  for (const effects::CorrectionPart& part : parts_.corrections) {
    for (std::size_t i = 0; i < part.correction->nonlinear().size(); ++i) {
      places.push_back(part.first_nonlinear + static_cast<int>(i));
    }
  }
  for (const effects::DelayPart& part : parts_.delays) places.push_back(part.parameter);
  for (const Effect& effect : effects) {
    if (!effect.driver || !effect.driver->is_step()) continue;
    const auto& shape = effect.driver->shape();
    if (!shape) continue;
    const std::string time = effect.name + "." + shape->name;
    std::erase_if(places, [&](int place) {
      return tables().nonlinear[static_cast<std::size_t>(place)].name == time;
    });
  }
  if (places.empty()) return;
  std::ranges::sort(places);
  const VectorXd zero = VectorXd::Zero(tables().n_2());
  const auto slopes = input_slopes(record, zero);
  for (const int place : places) moving_.push_back({place, step_of(place, slopes, record)});
}

/// So long that the input that it moves most moves by a small share of itself, or, where it is zero
/// unless something drives it, of its unit.
double ComposedTrajectory::step_of(int place, const std::vector<InputSlopes>& slopes,
                                   const Record& record) const {
  const Variable& parameter = tables().nonlinear[static_cast<std::size_t>(place)];
  double step = infinity;
  for (const auto& [input, slope] : slopes) {
    const auto moves = slope.col(place);
    const double most = rms({moves.data(), static_cast<std::size_t>(moves.size())});
    if (!(most > 0)) continue;
    const double size = record.has(input) ? rms(record.column(input)) : 0.0;
    step = std::min(step, share_of_input * (size > 0 ? size : 1.0) / most);
  }
  if (std::isfinite(step)) return step;
  const double width = parameter.upper - parameter.lower;  // a shape's, which acts by a coefficient
  return share_of_input * (std::isfinite(width) ? width : 1.0);
}

/// Inputs act as the effects leave them, with the linear parameters that vary.
std::unique_ptr<PathTangent> ComposedTrajectory::path_tangent(
    const Record& record, const VectorXd& xi, const std::optional<PathNoise>& noise) const {
  const VectorXd xi2 = xi.tail(tables().n_2());
  const ComposedSteps along(*this, record, xi);
  return std::make_unique<TrajectoryTangent>(
      TrajectoryTangent::Path{*this, record, xi},
      TrajectoryTangent::Inputs{*model_, correct(record, values_of(xi2)), along.own_parameters(),
                                along.drift()},
      noise);
}

std::unique_ptr<StateSteps> ComposedTrajectory::steps(const Record& record,
                                                      const VectorXd& xi) const {
  return std::make_unique<ComposedSteps>(*this, record, xi);
}

}  // namespace sepcal::states

namespace sepcal {

std::shared_ptr<const BlockModel> StateBlockModel::compose_with(
    std::shared_ptr<const BlockModel> self, const std::vector<Effect>& effects,
    const Record& record) const {
  return std::make_shared<const states::ComposedTrajectory>(
      std::static_pointer_cast<const StateBlockModel>(self), effects, record);
}

}  // namespace sepcal
