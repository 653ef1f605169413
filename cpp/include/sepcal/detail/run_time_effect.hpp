// SPDX-License-Identifier: BSD-3-Clause
// From an effect written as a struct (static_effect.hpp) to one that is chosen at run time, by its
// name.
#pragma once

#include <ceres/jet.h>

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sepcal/detail/effect.hpp"
#include "sepcal/detail/named_effects.hpp"
#include "sepcal/detail/static_effect.hpp"
#include "sepcal/static_model.hpp"

namespace sepcal {

/// A term as a model by itself: z = columns(u, xi2) xi1.
template <Term T>
struct TermModel {
  static constexpr int n_z = outputs_of_term<T>;
  static constexpr auto inputs = T::inputs;
  static constexpr auto linear = T::linear;
  static constexpr auto nonlinear = T::nonlinear;
  static constexpr bool dual_inputs = has_dual_inputs<T>();
  static constexpr std::array<Quantity, static_cast<std::size_t>(n_z)> outputs = [] {
    constexpr std::array<std::string_view, 9> names{"1", "2", "3", "4", "5", "6", "7", "8", "9"};
    static_assert(n_z <= static_cast<int>(names.size()));
    std::array<Quantity, static_cast<std::size_t>(n_z)> table{};
    for (std::size_t j = 0; j < table.size(); ++j) table[j] = {names[j], ""};
    return table;
  }();

  T term;

  template <class U, class X>
  Affine<X, n_z, static_cast<int>(linear.size())> at(
      const Vec<U, static_cast<int>(inputs.size())>& u,
      const Vec<X, static_cast<int>(nonlinear.size())>& xi2) const {
    Affine<X, n_z, static_cast<int>(linear.size())> z;
    z.A = term.columns(u, xi2).template cast<X>();
    z.b.setZero();
    return z;
  }
};

template <InputCorrection T>
class StaticCorrection final : public Correction {
 public:
  explicit StaticCorrection(T effect)
      : StaticCorrection(std::move(effect), {T::nonlinear.begin(), T::nonlinear.end()}) {}

  /// With names for T's parameters that are known only at run time.
  StaticCorrection(T effect, std::vector<Variable> nonlinear)
      : Correction({T::inputs.begin(), T::inputs.end()}, T::corrected, std::move(nonlinear)),
        effect_(std::move(effect)) {}

  void evaluate(const Block& block, const double* xi2, Eigen::Ref<Eigen::MatrixXd> values,
                Eigen::MatrixXd* slopes) const override {
    if (slopes != nullptr) return fill_slopes(block, xi2, values, *slopes);
    const Vec<double, n_2> x = Eigen::Map<const Vec<double, n_2>>(xi2);
    for (std::size_t row = 0; row < block.rows; ++row) {
      Vec<double, n_u> u;
      for (int i = 0; i < n_u; ++i) u[i] = block.inputs[static_cast<std::size_t>(i)][row];
      values.row(static_cast<Eigen::Index>(row)) = effect_.correct(u, x).transpose();
    }
  }

 private:
  static constexpr int n_u = static_cast<int>(T::inputs.size());
  static constexpr int n_2 = static_cast<int>(T::nonlinear.size());

  void fill_slopes(const Block& block, const double* xi2, Eigen::Ref<Eigen::MatrixXd> values,
                   Eigen::MatrixXd& slopes) const {
    using Dual = ceres::Jet<double, n_u + n_2>;
    Vec<Dual, n_2> x;
    for (int k = 0; k < n_2; ++k) x[k] = Dual(xi2[k], n_u + k);
    for (std::size_t row = 0; row < block.rows; ++row) {
      const auto at = static_cast<Eigen::Index>(row);
      Vec<Dual, n_u> u;
      for (int i = 0; i < n_u; ++i) u[i] = Dual(block.inputs[static_cast<std::size_t>(i)][row], i);
      const Vec<Dual, T::corrected> corrected = effect_.correct(u, x);
      for (int c = 0; c < T::corrected; ++c) {
        values(at, c) = corrected[c].a;
        slopes.row(at).segment(Eigen::Index{c} * (n_u + n_2), n_u + n_2) =
            corrected[c].v.transpose();
      }
    }
  }

  T effect_;
};

/// A term or an input correction as a run-time effect called `name`.
template <class T>
  requires Term<T> || InputCorrection<T>
Effect effect(std::string name, T made) {
  Effect result{.name = std::move(name)};
  if constexpr (Term<T>) {
    result.terms.push_back(block_model(TermModel<T>{std::move(made)}));
  } else {
    result.corrections.push_back(std::make_shared<const StaticCorrection<T>>(std::move(made)));
  }
  return result;
}

/// Makes an effect, called as its setting, of a term or an input correction written as a struct.
template <class T>
EffectKit::Maker maker_of(T made) {
  return [made](const BlockModel& /*model*/, EffectSetting& setting, Record& /*record*/) {
    return effect(setting.name, made);
  };
}

/// A term or an input correction written as a struct, by its name among a kit's or the caller's.
template <class T>
OwnEffects::value_type own_effect(const std::string& name, T made) {
  return {name, maker_of(std::move(made))};
}

}  // namespace sepcal
