// SPDX-License-Identifier: BSD-3-Clause
// Variances of many units of which each is known badly, moderated by what they have in common
// (Smyth 2004, Statistical Applications in Genetics and Molecular Biology 3(1), Sec. 6): with s_v^2
// ~ sigma_v^2 chi-squared(d_v) / d_v and 1/sigma_v^2 ~ chi-squared(d_0) / (d_0 s_0^2), the
// posterior (d_0 s_0^2 + d_v s_v^2) / (d_0 + d_v) has d_0 + d_v degrees of freedom.
#pragma once

#include <vector>

namespace sepcal::fleet {

struct Moderation {
  bool is_known = false;           // whether any unit shows its scatter
  double pooled = 1.0;             // of all units, weighted by their degrees of freedom
  std::vector<double> inflations;  // of each, moderated: at least 1, what noise models say
  std::vector<double> freedoms;    // infinite where nothing tells the units apart
};

/// `inflations` of variances by `freedoms`, 0 where a unit has none.
Moderation moderate(const std::vector<double>& inflations, const std::vector<double>& freedoms);

}  // namespace sepcal::fleet
