// SPDX-License-Identifier: BSD-3-Clause
// A result's message is one line: its sentences with "; " between. They are joined here, and told
// apart again where a page gives each a line of its own.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sepcal::base {

/// The text, in which a name may hold what stands between sentences: a label "turn; left".
std::string one_sentence(std::string text);

/// The message; of sentences that are empty nothing is said.
std::string join_sentences(const std::vector<std::string>& sentences);

/// The message's sentences; none of an empty one.
std::vector<std::string> split_sentences(std::string_view message);

}  // namespace sepcal::base
