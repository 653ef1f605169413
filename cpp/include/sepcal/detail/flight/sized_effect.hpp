// SPDX-License-Identifier: BSD-3-Clause
// An effect with the sizes of its coefficients, as a person writes it to have one hidden in a
// simulated flight or put into a recorded one: "wind[altitude_m]=0.01:0.02".
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sepcal {

struct SizedEffect {
  std::string name;

  /// One size for every component, or one a component in the order of the effect's parameters, or
  /// these and the shape parameter (t0, tau, exponent) last. Empty: the values stand elsewhere, in
  /// a simulation among the truth's parameters, "wind[altitude_m].n". A shape that isn't given is,
  /// in a simulation: t0 a third of the way through the record, tau of decay() and warm_up a fifth
  /// of its length, tau of delay() 0.05 s, exponent 0.7.
  std::vector<double> sizes{};
};

/// "E=SIZE" or "E=SIZE1:SIZE2:...". Throws Error that opens with `option`, as "--hide", and gives
/// the form.
SizedEffect parse_sized_effect(const std::string& text, std::string_view option);

}  // namespace sepcal
