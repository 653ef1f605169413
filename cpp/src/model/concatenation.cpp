// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/concatenation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sepcal/error.hpp"

namespace sepcal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Variable labelled(const std::string& label, Variable variable) {
  if (!label.empty()) variable.name = label + "." + variable.name;
  return variable;
}

void append(std::vector<Variable>& table, const std::string& label,
            const std::vector<Variable>& more) {
  for (const Variable& variable : more) table.push_back(labelled(label, variable));
}

/// The place of an input, which joins the table where it is new. One that some sensor must have is
/// no input that data may lack.
int join_input(std::vector<Variable>& inputs, const Variable& input) {
  const auto there = std::ranges::find(inputs, input.name, &Variable::name);
  if (there == inputs.end()) {
    inputs.push_back(input);
    return static_cast<int>(inputs.size()) - 1;
  }
  if (there->unit != input.unit) {
    throw Error("input '" + input.name + "' is in " + there->unit + " for one sensor and in " +
                input.unit + " for another");
  }
  if (there->absent != input.absent) there->absent = not_a_number;
  return static_cast<int>(there - inputs.begin());
}

/// A sensor within the whole: where its tables begin there.
struct Part {
  std::shared_ptr<const BlockModel> model;
  std::vector<int> inputs;  // the place of each among those of the whole
  int z = 0;
  int linear = 0;
  int nonlinear = 0;

  const Tables& tables() const { return model->tables(); }
};

struct Layout {
  Tables tables;
  std::vector<Part> parts;
};

Layout lay_out(const std::vector<Sensor>& sensors) {
  if (sensors.empty()) throw Error("concatenate() takes one sensor or more; it was given none");
  Layout layout;
  Tables& whole = layout.tables;
  for (const auto& [label, model] : sensors) {
    if (model->new_carry() != nullptr) {
      throw Error((label.empty() ? "a sensor" : "'" + label + "'") +
                  " has a state; concatenate() takes models of independent samples");
    }
    Part part{.model = model,
              .inputs = {},
              .z = whole.n_z(),
              .linear = whole.n_1(),
              .nonlinear = whole.n_2()};
    const Tables& own = model->tables();
    for (const Variable& input : own.inputs) {
      part.inputs.push_back(join_input(whole.inputs, input));
    }
    append(whole.outputs, label, own.outputs);
    append(whole.linear, label, own.linear);
    append(whole.nonlinear, label, own.nonlinear);
    layout.parts.push_back(std::move(part));
  }
  return layout;
}

class Concatenation final : public BlockModel {
 public:
  explicit Concatenation(Layout layout)
      : BlockModel(std::move(layout.tables)), parts_(std::move(layout.parts)) {}

  void evaluate(const Block& block, const double* xi2, const double* xi1, Carry* /*carry*/,
                Eigen::Ref<MatrixXd> rows) const override {
    const auto N = static_cast<Index>(block.rows);
    rows.setZero();
    for (const Part& part : parts_) {
      const Seen seen(part, block);
      const Index n_1 = part.tables().n_1();
      const Index n_2 = xi1 == nullptr ? 0 : part.tables().n_2();
      MatrixXd own(part.tables().n_z() * N, n_1 + n_2 + 1);
      part.model->evaluate(seen.block, xi2 + part.nonlinear,
                           xi1 == nullptr ? nullptr : xi1 + part.linear, nullptr, own);
      auto mine = rows.middleRows(part.z * N, own.rows());
      mine.middleCols(part.linear, n_1) = own.leftCols(n_1);
      if (n_2 > 0) mine.middleCols(tables().n_1() + part.nonlinear, n_2) = own.middleCols(n_1, n_2);
      mine.rightCols<1>() = own.rightCols<1>();
    }
  }

  void input_tangent(const Block& block, const double* xi2, const double* xi1,
                     std::span<const int> inputs, Eigen::Ref<MatrixXd> columns) const override {
    const auto N = static_cast<Index>(block.rows);
    columns.setZero();
    for (const Part& part : parts_) {
      std::vector<int> own_inputs;
      std::vector<Index> places;
      for (std::size_t k = 0; k < inputs.size(); ++k) {
        const auto there = std::ranges::find(part.inputs, inputs[k]);
        if (there == part.inputs.end()) continue;
        own_inputs.push_back(static_cast<int>(there - part.inputs.begin()));
        places.push_back(static_cast<Index>(k));
      }
      if (places.empty()) continue;
      const Seen seen(part, block);
      MatrixXd own(part.tables().n_z() * N, static_cast<Index>(places.size()));
      part.model->input_tangent(seen.block, xi2 + part.nonlinear, xi1 + part.linear, own_inputs,
                                own);
      columns.middleRows(part.z * N, own.rows())(Eigen::all, places) = own;
    }
  }

  bool add_second_derivatives(const Block& block, const double* xi2, const double* xi1,
                              Eigen::Ref<MatrixXd> sum) const override {
    MatrixXd whole = MatrixXd::Zero(sum.rows(), sum.cols());
    for (const Part& part : parts_) {
      const Index n_2 = part.tables().n_2();
      MatrixXd own = MatrixXd::Zero(n_2, n_2);
      const Seen seen(part, block);
      if (!part.model->add_second_derivatives(seen.block, xi2 + part.nonlinear, xi1 + part.linear,
                                              own)) {
        return false;
      }
      whole.block(part.nonlinear, part.nonlinear, n_2, n_2) = own;
    }
    sum += whole;
    return true;
  }

  /// What all sensors guess, side by side; none where one of them doesn't.
  MatrixXd guess(const MatrixXd& u, const MatrixXd& z) const override {
    std::vector<MatrixXd> guesses;
    Index points = -1;
    for (const Part& part : parts_) {
      if (part.tables().n_2() == 0) {
        guesses.emplace_back(0, 0);
        continue;
      }
      guesses.push_back(
          part.model->guess(u(Eigen::all, part.inputs), z.middleCols(part.z, part.tables().n_z())));
      points = points < 0 ? guesses.back().cols() : std::min(points, guesses.back().cols());
    }
    MatrixXd result(tables().n_2(), std::max<Index>(points, 0));
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      const Index n_2 = parts_[i].tables().n_2();
      if (n_2 > 0) {
        result.middleRows(parts_[i].nonlinear, n_2) = guesses[i].leftCols(result.cols());
      }
    }
    return result;
  }

 private:
  /// The block as a sensor sees it.
  struct Seen {
    std::vector<const double*> columns;
    Block block;

    Seen(const Part& part, const Block& whole) : block(whole) {
      for (const int input : part.inputs) {
        columns.push_back(whole.inputs[static_cast<std::size_t>(input)]);
      }
      block.inputs = columns;
      block.kept = nullptr;
    }
    Seen(const Seen&) = delete;
    Seen& operator=(const Seen&) = delete;
    ~Seen() = default;
  };

  std::vector<Part> parts_;
};

}  // namespace

std::shared_ptr<const BlockModel> concatenate(const std::vector<Sensor>& sensors) {
  return std::make_shared<const Concatenation>(lay_out(sensors));
}

}  // namespace sepcal
