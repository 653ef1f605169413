// SPDX-License-Identifier: BSD-3-Clause
// From a model written as a struct to the waist: one templated loop that evaluates at(u, xi2) with
// doubles, or with Ceres' dual numbers in xi2 alone. The columns of A are already the derivatives
// with respect to xi1, so nothing else is differentiated.
#pragma once

#include <ceres/jet.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "sepcal/detail/block_model.hpp"
#include "sepcal/detail/enclosed_dual.hpp"
#include "sepcal/detail/model.hpp"
#include "sepcal/detail/nested_dual.hpp"

namespace sepcal {

/// The four tables of a model, at run time.
template <SeparableModel M>
Tables tables_of() {
  const auto variables = [](const auto& table) {
    return std::vector<Variable>(table.begin(), table.end());
  };
  return {variables(M::inputs), variables(M::outputs), variables(M::linear),
          variables(M::nonlinear)};
}

/// at() must take any number for xi2 and answer in it: sepcal differentiates it with dual numbers.
template <class M>
concept DifferentiableModel =
    requires(const M& model, const Vec<double, Sizes<M>::n_u>& u,
             const Vec<ceres::Jet<double, Sizes<M>::n_2>, Sizes<M>::n_2>& xi2) {
      {
        model.at(u, xi2)
      } -> std::same_as<typename Sizes<M>::template Result<ceres::Jet<double, Sizes<M>::n_2>>>;
    };

template <SeparableModel M>
class StaticModel final : public BlockModel {
  static_assert(Sizes<M>::n_2 == 0 || DifferentiableModel<M>,
                "at(u, xi2) must be a template in xi2's number type and return an Affine of it");

 public:
  explicit StaticModel(M model) : BlockModel(tables_of<M>()), model_(std::move(model)) {}

  void evaluate(const Block& block, const double* xi2, const double* xi1, Carry* /*carry*/,
                Eigen::Ref<Eigen::MatrixXd> rows) const override {
    const bool tangent = n_2 > 0 && xi1 != nullptr;
    if constexpr (has_lanes<M>()) {
      const LaneKernel& kernel = lane_kernel<M>();
      const auto stride = static_cast<std::size_t>(rows.outerStride());
      const LaneRows lanes{block.inputs.data(), block.rows, block.kept};
      if (tangent) {
        kernel.fill_tangent(&model_, lanes, xi2, xi1, rows.data(), stride);
      } else {
        kernel.fill_values(&model_, lanes, xi2, rows.data(), stride);
      }
    } else {
      if constexpr (n_2 > 0) {
        if (tangent) return fill_tangent(block, xi2, xi1, rows);
      }
      fill_values(block, xi2, rows);
    }
  }

  std::size_t kept_bytes(std::size_t rows) const override {
    if constexpr (has_lanes<M>()) {
      const LaneKernel& kernel = lane_kernel<M>();
      return (rows + kernel.width - 1) / kernel.width * kernel.kept_bytes;
    }
    return BlockModel::kept_bytes(rows);
  }

  void keep_rows(const Block& block, void* to) const override {
    if constexpr (has_lanes<M>()) {
      lane_kernel<M>().keep(&model_, block.inputs.data(), block.rows, to);
    } else {
      BlockModel::keep_rows(block, to);
    }
  }

  std::size_t lane_width() const override {
    if constexpr (has_lanes<M>()) return lane_kernel<M>().width;
    return 0;
  }

  bool evaluate_lanes(const LaneBlock& block, const PointTiles& points, double* scratch,
                      const VisitTile& visit) const override {
    if constexpr (has_lanes<M>()) {
      const auto call = [](void* visitor, std::size_t tile, double* rows) {
        (*static_cast<const VisitTile* const*>(visitor))->operator()(tile, rows);
      };
      const VisitTile* visitor = &visit;
      return lane_kernel<M>().evaluate(&model_, block, points, scratch, call,
                                       static_cast<void*>(&visitor));
    } else {
      return BlockModel::evaluate_lanes(block, points, scratch, visit);
    }
  }

  std::size_t prepared_bytes() const override {
    if constexpr (has_lanes<M>()) return lane_kernel<M>().prepared_bytes;
    return 0;
  }

  void prepare_rows(const Block& block, void* to) const override {
    if constexpr (has_lanes<M>()) {
      lane_kernel<M>().prepare(&model_, block.inputs.data(), block.rows, to);
    } else {
      BlockModel::prepare_rows(block, to);
    }
  }

  void fill_trials(const TrialRows& trials, double* to) const override {
    if constexpr (has_lanes<M>()) {
      lane_kernel<M>().fill_trials(&model_, trials, to);
    } else {
      BlockModel::fill_trials(trials, to);
    }
  }

  void input_tangent(const Block& block, const double* xi2, const double* xi1,
                     std::span<const int> inputs,
                     Eigen::Ref<Eigen::MatrixXd> columns) const override {
    if constexpr (n_u > 0 && has_dual_inputs<M>()) {
      for (std::size_t first = 0; first < inputs.size(); first += inputs_at_a_time) {
        const std::size_t count = std::min<std::size_t>(inputs_at_a_time, inputs.size() - first);
        const std::span<const int> some = inputs.subspan(first, count);
        if constexpr (has_lanes<M>()) {
          lane_kernel<M>().fill_input_tangent(&model_, {block.inputs.data(), block.rows}, xi2, xi1,
                                              some.data(), count,
                                              columns.col(static_cast<Eigen::Index>(first)).data(),
                                              static_cast<std::size_t>(columns.outerStride()));
        } else {
          fill_input_tangent(block, xi2, xi1, some,
                             columns.middleCols(static_cast<Eigen::Index>(first),
                                                static_cast<Eigen::Index>(count)));
        }
      }
    } else {
      BlockModel::input_tangent(block, xi2, xi1, inputs, columns);
    }
  }

  bool add_second_derivatives(const Block& block, const double* xi2, const double* xi1,
                              Eigen::Ref<Eigen::MatrixXd> sum) const override {
    if constexpr (n_2 > 0 && has_nested_duals<M>()) {
      sum_second_derivatives(block, xi2, xi1, sum);
      return true;
    } else {
      return BlockModel::add_second_derivatives(block, xi2, xi1, sum);
    }
  }

  bool enclose(const Block& block, std::span<const Enclosure> xi2,
               EnclosedRows& rows) const override {
    if constexpr (n_2 > 0 && has_enclosures<M>()) {
      fill_enclosures(block, xi2, rows);
      return true;
    } else {
      return BlockModel::enclose(block, xi2, rows);
    }
  }

  Eigen::MatrixXd guess(const Eigen::MatrixXd& u, const Eigen::MatrixXd& z) const override {
    if constexpr (requires { model_.guess(u, z); }) {
      return model_.guess(u, z);
    } else {
      return BlockModel::guess(u, z);
    }
  }

 private:
  static constexpr int n_u = Sizes<M>::n_u;
  static constexpr int n_z = Sizes<M>::n_z;
  static constexpr int n_1 = Sizes<M>::n_1;
  static constexpr int n_2 = Sizes<M>::n_2;

  static Vec<double, n_u> sample(const Block& block, std::size_t row) {
    Vec<double, n_u> u;
    for (int i = 0; i < n_u; ++i) u[i] = block.inputs[static_cast<std::size_t>(i)][row];
    return u;
  }

  /// In ranges, where at() takes them: what is computed of the inputs alone is then rounded
  /// outwards too.
  static auto enclosed_sample(const Block& block, std::size_t row) {
    if constexpr (has_dual_inputs<M>()) {
      return Vec<Enclosure, n_u>(sample(block, row).template cast<Enclosure>());
    } else {
      return sample(block, row);
    }
  }

  void fill_values(const Block& block, const double* xi2, Eigen::Ref<Eigen::MatrixXd> rows) const
    requires(!has_lanes<M>())
  {
    const Vec<double, n_2> x = Eigen::Map<const Vec<double, n_2>>(xi2);
    for (std::size_t row = 0; row < block.rows; ++row) {
      const auto [A, b] = model_.at(sample(block, row), x);
      for (int j = 0; j < n_z; ++j) {
        const auto at = static_cast<Eigen::Index>(static_cast<std::size_t>(j) * block.rows + row);
        for (int k = 0; k < n_1; ++k) rows(at, k) = A(j, k);
        rows(at, n_1) = b[j];
      }
    }
  }

  void fill_tangent(const Block& block, const double* xi2, const double* xi1,
                    Eigen::Ref<Eigen::MatrixXd> rows) const
    requires(!has_lanes<M>())
  {
    using Dual = ceres::Jet<double, n_2>;
    Vec<Dual, n_2> x;
    for (int i = 0; i < n_2; ++i) x[i] = Dual(xi2[i], i);
    for (std::size_t row = 0; row < block.rows; ++row) {
      const auto [A, b] = model_.at(sample(block, row), x);
      for (int j = 0; j < n_z; ++j) {
        const auto at = static_cast<Eigen::Index>(static_cast<std::size_t>(j) * block.rows + row);
        auto tangent = b[j].v;
        for (int k = 0; k < n_1; ++k) {
          rows(at, k) = A(j, k).a;
          tangent += xi1[k] * A(j, k).v;
        }
        for (int i = 0; i < n_2; ++i) rows(at, n_1 + i) = tangent[i];
        rows(at, n_1 + n_2) = b[j].a;
      }
    }
  }

  void sum_second_derivatives(const Block& block, const double* xi2, const double* xi1,
                              Eigen::Ref<Eigen::MatrixXd> sum) const {
    using Dual = NestedDual<n_2>;
    Vec<Dual, n_2> x;
    for (int i = 0; i < n_2; ++i) x[i] = Dual(xi2[i], i);
    for (std::size_t row = 0; row < block.rows; ++row) {
      const auto [A, b] = model_.at(sample(block, row), x);
      for (int j = 0; j < n_z; ++j) {
        Dual z = b[j];
        for (int k = 0; k < n_1; ++k) z += xi1[k] * A(j, k);
        for (int i = 0; i < n_2; ++i) {
          for (int k = 0; k < n_2; ++k) sum(i, k) += z.second_derivative(i, k);
        }
      }
    }
  }

  void fill_enclosures(const Block& block, std::span<const Enclosure> xi2, EnclosedRows& rows) const
    requires(has_enclosures<M>())
  {
    using Dual = EnclosedDual<n_2>;
    rows.columns = n_1 + 1;
    rows.n_2 = n_2;
    rows.resize(static_cast<Eigen::Index>(n_z * block.rows));
    Vec<Dual, n_2> x;
    for (int i = 0; i < n_2; ++i) x[i] = Dual(xi2[static_cast<std::size_t>(i)], i);
    for (std::size_t row = 0; row < block.rows; ++row) {
      const auto [A, b] = model_.at(enclosed_sample(block, row), x);
      for (int j = 0; j < n_z; ++j) {
        const auto at = static_cast<Eigen::Index>(static_cast<std::size_t>(j) * block.rows + row);
        for (int k = 0; k < n_1; ++k) A(j, k).copy_to(rows.at(at, k));
        b[j].copy_to(rows.at(at, n_1));
      }
    }
  }

  void fill_input_tangent(const Block& block, const double* xi2, const double* xi1,
                          std::span<const int> inputs, Eigen::Ref<Eigen::MatrixXd> columns) const
    requires(!has_lanes<M>())
  {
    using Dual = ceres::Jet<double, inputs_at_a_time>;
    Vec<Dual, n_2> x;
    for (int i = 0; i < n_2; ++i) x[i] = Dual(xi2[i]);
    for (std::size_t row = 0; row < block.rows; ++row) {
      Vec<Dual, n_u> u = sample(block, row).template cast<Dual>();
      for (std::size_t i = 0; i < inputs.size(); ++i) {
        u[inputs[i]].v[static_cast<Eigen::Index>(i)] = 1.0;
      }
      const auto [A, b] = model_.at(u, x);
      for (int j = 0; j < n_z; ++j) {
        const auto at = static_cast<Eigen::Index>(static_cast<std::size_t>(j) * block.rows + row);
        auto tangent = b[j].v;
        for (int k = 0; k < n_1; ++k) tangent += xi1[k] * A(j, k).v;
        for (std::size_t i = 0; i < inputs.size(); ++i) {
          columns(at, static_cast<Eigen::Index>(i)) = tangent[static_cast<Eigen::Index>(i)];
        }
      }
    }
  }

  M model_;
};

/// A model as everything below the waist takes it.
template <SeparableModel M>
std::shared_ptr<const BlockModel> block_model(M model) {
  return std::make_shared<const StaticModel<M>>(std::move(model));
}

}  // namespace sepcal
