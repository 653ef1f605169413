// SPDX-License-Identifier: BSD-3-Clause
// One value an output, to and from JSON; and the words in which all results are written.
#pragma once

#include <string>
#include <vector>

#include "flight/files/json_values.hpp"
#include "sepcal/fit.hpp"

namespace sepcal::json {

using files::describe;
using files::elements_of;
using files::entries_of;
using files::Json;
using files::matrix;
using files::matrix_of;
using files::number;
using files::number_or;
using files::point;
using files::point_of;
using files::text_of;
using files::whole_number;

/// The catalogues of several models, an object an effect.
Json write_catalogue(const std::vector<std::string>& models);

/// {"vn": 0.15, ...}
Json by_name(const std::vector<OutputValue>& values);

/// A number that calibrations of before lack, or null: NaN.
double number_at(const Json& object, const char* key);

/// A value of every one of `names`. Throws Json::exception where one is missing.
std::vector<OutputValue> values_by_name(const std::vector<std::string>& names, const Json& object);

}  // namespace sepcal::json
