// SPDX-License-Identifier: BSD-3-Clause
#include "flight/text/status_text.hpp"

#include <fmt/format.h>

#include "flight/verbs/at_bound.hpp"

namespace sepcal::text {

std::string status_line(FitStatus status, const std::vector<std::string>& at_bound,
                        const std::string& message) {
  std::string text = fmt::format("status: {}", to_string(status));
  if (!at_bound.empty()) {
    text += fmt::format(
        ", {} at {}: {}",
        at_bound.size() == 1 ? "1 parameter" : fmt::format("{} parameters", at_bound.size()),
        at_bound.size() == 1 ? "its bound" : "their bounds", fmt::join(at_bound, ", "));
  }
  if (!message.empty()) text += (at_bound.empty() ? ": " : "; ") + message;
  return text + "\n";
}

std::string status_line(const Fit& fit) {
  return status_line(fit.status, verbs::names_at_bound(fit), fit.message);
}

}  // namespace sepcal::text
