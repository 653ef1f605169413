// SPDX-License-Identifier: BSD-3-Clause
// UTF-8 (RFC 3629), character by character.
#pragma once

#include <cstddef>
#include <string_view>

namespace sepcal::base {

/// Bytes of the character that begins at text[at], `at` < text.size(); 0 where none does: a stray
/// or missing continuation, an overlong form, a surrogate, a code point above U+10FFFF.
std::size_t utf8_length(std::string_view text, std::size_t at);

}  // namespace sepcal::base
