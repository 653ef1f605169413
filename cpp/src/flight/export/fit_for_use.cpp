// SPDX-License-Identifier: BSD-3-Clause
#include "flight/export/fit_for_use.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "flight/verbs/at_bound.hpp"
#include "sepcal/error.hpp"

namespace sepcal::exporting {

void check_fit_for_use(const Calibration& calibration, const std::string& which) {
  const Fit& fit = calibration.fit;
  const std::vector<std::string> at_bound = verbs::names_at_bound(fit);
  std::string why;
  if (fit.status == FitStatus::not_converged) why = "did not converge";
  if (fit.status == FitStatus::not_identifiable) why = "is not all determined by its flight";
  if (why.empty() && !at_bound.empty()) {
    why = fmt::format("has {} at {}", fmt::join(at_bound, ", "),
                      at_bound.size() == 1 ? "its bound" : "their bounds");
  }
  if (why.empty()) return;
  throw OptionError(
      {fmt::format("{} {}, so that no vehicle should load it; fit it again, or ", which, why),
       Option{"force"}, " exports it all the same"});
}

}  // namespace sepcal::exporting
