// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "sepcal/flight/flight.hpp"

namespace sepcal::files {

/// SHA-256 of the file's bytes; of arrays, which have none, of their headers and values.
std::string digest_of(const Flight& flight);

}  // namespace sepcal::files
