// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "base/page.hpp"
#include "flight/text/pages.hpp"
#include "sepcal/detail/flight/effect_catalogue.hpp"

namespace sepcal {

using base::Page;
using base::page;

Page text::catalogue_page(std::string_view model) {
  std::size_t name = 0;
  std::size_t equation = 0;
  std::size_t driver = 0;
  for (const CataloguedEffect& effect : effect_catalogue(model)) {
    name = std::max(name, effect.name.size());
    equation = std::max(equation, effect.equation.size());
    driver = std::max(driver, effect.drivers.size());
  }
  const auto row = [&](std::string_view a, std::string_view b, std::string_view c,
                       std::string_view d) {
    return page("{:<{}}  {:<{}}  {:<{}}  {}\n", a, name, b, equation, c, driver, d);
  };
  Page text = page("{}: what its model may lack; fit --effect E, or add ... E\n\n{}", model,
                   row("effect", "the model with it", "driver", "unit"));
  for (const CataloguedEffect& effect : effect_catalogue(model)) {
    text += row(effect.name, effect.equation, effect.drivers, effect.unit);
  }
  text +=
      "\nDRIVER: a numeric column by its header, or time, alpha, beta, q, r where there; x "
      "alone or "
      "x^2 to x^9,\nx^n (n fitted), spline(x,k), levels(x,a,b), step(time), ramp(time), "
      "decay(time), delay(x), "
      "maneuver.\n\n";
  return text;
}

std::string catalogue_text(std::string_view model) { return text::catalogue_page(model).text(); }

}  // namespace sepcal
