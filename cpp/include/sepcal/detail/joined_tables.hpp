// SPDX-License-Identifier: BSD-3-Clause
// Tables of quantities joined while compiling: what models that are made of parts have in common.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

#include "sepcal/detail/model.hpp"

namespace sepcal::composing {

/// The place of a name; the table's size where it isn't there.
constexpr std::size_t find(const auto& table, std::string_view name) {
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (table[i].name == name) return i;
  }
  return table.size();
}

/// Quantities of `more` whose names `table` lacks.
template <std::size_t N, std::size_t M>
constexpr std::size_t count_new(const std::array<Quantity, N>& table,
                                const std::array<Quantity, M>& more) {
  std::size_t count = 0;
  for (const Quantity& quantity : more) count += find(table, quantity.name) == N ? 1 : 0;
  return count;
}

template <std::size_t N, std::size_t M>
constexpr std::array<Quantity, N + M> join(const std::array<Quantity, N>& a,
                                           const std::array<Quantity, M>& b) {
  std::array<Quantity, N + M> joined{};
  std::copy(a.begin(), a.end(), joined.begin());
  std::copy(b.begin(), b.end(), joined.begin() + N);
  return joined;
}

/// Any number of tables, one after another.
template <class Table>
constexpr Table join_all(const Table& table) {
  return table;
}
template <class Table, class... Tables>
constexpr auto join_all(const Table& table, const Tables&... more) {
  return join(table, join_all(more...));
}

/// The inputs of both, each once.
template <class A, class B>
constexpr auto merge() {
  constexpr std::size_t n = A::inputs.size();
  std::array<Quantity, n + count_new(A::inputs, B::inputs)> merged{};
  std::copy(A::inputs.begin(), A::inputs.end(), merged.begin());
  std::size_t next = n;
  for (const Quantity& input : B::inputs) {
    if (find(A::inputs, input.name) == n) merged[next++] = input;
  }
  return merged;
}

/// Whether inputs of one name are in one unit.
template <class A, class B>
constexpr bool same_units() {
  return std::all_of(B::inputs.begin(), B::inputs.end(), [](const Quantity& input) {
    const std::size_t at = find(A::inputs, input.name);
    return at == A::inputs.size() || A::inputs[at].unit.empty() || input.unit.empty() ||
           A::inputs[at].unit == input.unit;
  });
}

/// Where the inputs of a part stand among those of the whole: found while compiling.
template <class Whole, class Part>
inline constexpr auto positions = [] {
  std::array<int, Part::inputs.size()> places{};
  for (std::size_t i = 0; i < places.size(); ++i)
    places[i] = static_cast<int>(find(Whole::inputs, Part::inputs[i].name));
  return places;
}();

/// That of input i.
template <class Whole, class Part>
constexpr int position(int i) {
  return positions<Whole, Part>[static_cast<std::size_t>(i)];
}

/// A part's inputs out of those of the whole.
template <class Whole, class Part, class T>
Vec<T, static_cast<int>(Part::inputs.size())> select(
    const Vec<T, static_cast<int>(Whole::inputs.size())>& u) {
  Vec<T, static_cast<int>(Part::inputs.size())> selected;
  for (int i = 0; i < selected.size(); ++i) selected[i] = u[position<Whole, Part>(i)];
  return selected;
}

}  // namespace sepcal::composing
