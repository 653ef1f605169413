// SPDX-License-Identifier: BSD-3-Clause
// Several sensors as one model (Sun & Gebre-Egziabher, Eq. A5): outputs and parameters stand one
// after another, A is block-diagonal, inputs of one name are one input. A sum of sensors is a model
// again, so that three are two and one.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "sepcal/detail/joined_tables.hpp"
#include "sepcal/detail/model.hpp"

namespace sepcal {

/// A text as a template's argument.
template <std::size_t N>
struct Label {
  std::array<char, N> text{};
  // NOLINTNEXTLINE(google-explicit-constructor,cppcoreguidelines-avoid-c-arrays): a literal is one
  constexpr Label(const char (&literal)[N]) { std::copy_n(literal, N, text.begin()); }
  static constexpr std::size_t length() { return N - 1; }
};

namespace composing {

/// A table whose names begin with a label and a dot: "mag.lambda_x".
template <Label label, const auto& table>
struct Labelling {
  static constexpr std::size_t size = table.size();
  static constexpr std::size_t width = [] {
    std::size_t longest = 0;
    for (const Quantity& quantity : table) longest = std::max(longest, quantity.name.size());
    return label.length() + 1 + longest;
  }();
  static constexpr auto names = [] {
    std::array<std::array<char, width>, size> result{};
    for (std::size_t i = 0; i < size; ++i) {
      auto* end = std::copy_n(label.text.begin(), label.length(), result[i].begin());
      *end++ = '.';
      std::copy(table[i].name.begin(), table[i].name.end(), end);
    }
    return result;
  }();
  static constexpr auto quantities = [] {
    std::array<Quantity, size> result = table;
    for (std::size_t i = 0; i < size; ++i) {
      result[i].name = {names[i].data(), label.length() + 1 + table[i].name.size()};
    }
    return result;
  }();
};

/// Whether no name is in both tables.
constexpr bool nothing_in_common(const auto& a, const auto& b) {
  return std::none_of(b.begin(), b.end(),
                      [&](const Quantity& one) { return find(a, one.name) < a.size(); });
}

}  // namespace composing

/// A model whose outputs and parameters are called "label.name", so that it may stand beside its
/// like. Inputs keep their names: sensors on one vehicle see the same of them.
template <Label label, SeparableModel M>
struct Labelled : M {
  static constexpr auto outputs = composing::Labelling<label, M::outputs>::quantities;
  static constexpr auto linear = composing::Labelling<label, M::linear>::quantities;
  static constexpr auto nonlinear = composing::Labelling<label, M::nonlinear>::quantities;
};

/// Two models side by side.
template <SeparableModel A, SeparableModel B>
struct Concatenated {
  static_assert(composing::nothing_in_common(composing::join(A::linear, A::nonlinear),
                                             composing::join(B::linear, B::nonlinear)) &&
                    composing::nothing_in_common(A::outputs, B::outputs),
                "a parameter or an output of one name belongs to both sensors: say Labelled");
  static_assert(composing::same_units<A, B>(), "an input is in another unit for each sensor");

  static constexpr auto inputs = composing::merge<A, B>();
  static constexpr auto outputs = composing::join(A::outputs, B::outputs);
  static constexpr auto linear = composing::join(A::linear, B::linear);
  static constexpr auto nonlinear = composing::join(A::nonlinear, B::nonlinear);
  static constexpr bool dual_inputs = has_dual_inputs<A>() && has_dual_inputs<B>();
  static constexpr bool nested_duals = has_nested_duals<A>() && has_nested_duals<B>();

  A first;
  B second;

  template <class U, class X>
  Affine<X, Sizes<Concatenated>::n_z, Sizes<Concatenated>::n_1> at(
      const Vec<U, static_cast<int>(inputs.size())>& u,
      const Vec<X, static_cast<int>(nonlinear.size())>& xi2) const {
    const Vec<X, Sizes<A>::n_2> of_first = xi2.template head<Sizes<A>::n_2>();
    const Vec<X, Sizes<B>::n_2> of_second = xi2.template tail<Sizes<B>::n_2>();
    const auto [A_1, b_1] = first.at(composing::select<Concatenated, A>(u), of_first);
    const auto [A_2, b_2] = second.at(composing::select<Concatenated, B>(u), of_second);
    Affine<X, Sizes<Concatenated>::n_z, Sizes<Concatenated>::n_1> z;
    z.A.setZero();
    z.A.template topLeftCorner<Sizes<A>::n_z, Sizes<A>::n_1>() = A_1;
    z.A.template bottomRightCorner<Sizes<B>::n_z, Sizes<B>::n_1>() = A_2;
    z.b << b_1, b_2;
    return z;
  }

  /// What both guess, side by side; none where one of them doesn't.
  Eigen::MatrixXd guess(const Eigen::MatrixXd& u, const Eigen::MatrixXd& z) const {
    const Eigen::MatrixXd a = guess_of(first, u, z.leftCols(Sizes<A>::n_z));
    const Eigen::MatrixXd b = guess_of(second, u, z.rightCols(Sizes<B>::n_z));
    const Eigen::Index both = std::min(a.cols(), b.cols());
    Eigen::MatrixXd result(Sizes<Concatenated>::n_2, both);
    result << a.leftCols(both), b.leftCols(both);
    return result;
  }

 private:
  /// Of a model without nonlinear parameters one empty guess.
  template <class Part>
  static Eigen::MatrixXd guess_of(const Part& part, const Eigen::MatrixXd& u,
                                  const Eigen::MatrixXd& z) {
    if constexpr (requires { part.guess(u, z); }) {
      Eigen::MatrixXd own(u.rows(), Sizes<Part>::n_u);
      for (int i = 0; i < Sizes<Part>::n_u; ++i) {
        own.col(i) = u.col(composing::position<Concatenated, Part>(i));
      }
      return part.guess(own, z);
    } else {
      return Eigen::MatrixXd(Sizes<Part>::n_2, Sizes<Part>::n_2 == 0 ? 1 : 0);
    }
  }
};

/// All of them as one model, Eq. A5.
template <SeparableModel A, SeparableModel B>
constexpr Concatenated<A, B> concatenate(A a, B b) {
  return {std::move(a), std::move(b)};
}
template <SeparableModel A, SeparableModel B, SeparableModel... More>
constexpr auto concatenate(A a, B b, More... more) {
  return concatenate(concatenate(std::move(a), std::move(b)), std::move(more)...);
}

}  // namespace sepcal
