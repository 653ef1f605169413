// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/error.hpp"

#include "base/escaping.hpp"

namespace sepcal {

Error::Error(const std::string& message) : std::runtime_error(base::in_line(message)) {}

}  // namespace sepcal
