// SPDX-License-Identifier: BSD-3-Clause
// Pages that are parts of other pages.
#pragma once

#include <string_view>

#include "base/page.hpp"
#include "sepcal/flight/calibration.hpp"
#include "sepcal/flight/stepwise.hpp"

namespace sepcal::text {

base::Page calibration_page(const Calibration& calibration, Detail detail);

base::Page catalogue_page(std::string_view model);

base::Page course_page(const Stepwise& course);

}  // namespace sepcal::text
