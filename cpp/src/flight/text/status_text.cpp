// SPDX-License-Identifier: BSD-3-Clause
#include "flight/text/status_text.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "base/page.hpp"
#include "base/sentences.hpp"
#include "flight/verbs/at_bound.hpp"

namespace sepcal::text {

using base::joined;
using base::Page;
using base::page;

namespace {

constexpr std::size_t most_sentences = 3;
constexpr std::size_t longest_line = 96;  // beside the indent, with room for a margin

constexpr int serious = 1;  // a sentence that isn't listed

/// How bad it is, least is worst: what nothing determines, what failed, what is poorly determined,
/// what was done about it.
constexpr std::array<std::pair<std::string_view, int>, 12> ranks{{
    {" can't be told apart", 0},
    {" can't be determined", 0},
    {" is not determined", 0},
    {" hard to tell apart", 2},
    {" fell back to joint", 3},
    {"standard errors are a lower bound", 3},
    {" is by blocks of the record", 3},
    {" is what blocks of the record allow", 3},
    {" is by the noise model", 3},
    {" rows count as one", 3},
    {"gaps cut the record", 3},
    {" more (see ", 4},
}};

int rank_of(std::string_view sentence) {
  for (const auto& [words, rank] : ranks) {
    if (sentence.find(words) != std::string_view::npos) return rank;
  }
  return serious;
}

/// The sentence without its reasons, which follow a colon, where it is too long for a line.
std::string shorten(const std::string& sentence) {
  return sentence.size() > longest_line ? sentence.substr(0, sentence.find(": ")) : sentence;
}

}  // namespace

std::vector<std::string> sentences(const std::string& message) {
  std::vector<std::string> result = base::split_sentences(message);
  std::ranges::stable_sort(result, {}, rank_of);
  return result;
}

Page sentence_lines(const std::string& message, Detail detail) {
  Page text;
  bool hides = false;
  std::size_t shown = 0;
  for (const std::string& sentence : sentences(message)) {
    const bool whole = detail == Detail::explained;
    if (!whole && shown++ == most_sentences) {
      hides = true;
      break;
    }
    const std::string line = whole ? sentence : shorten(sentence);
    hides = hides || line != sentence;
    text += page("  {}\n", line);
  }
  return hides ? text + "  ... more with --explain\n" : text;
}

Page status_lines(FitStatus status, const std::vector<std::string>& at_bound,
                  const std::string& message, Detail detail) {
  Page text = page("status: {}", to_string(status));
  if (!at_bound.empty()) {
    text +=
        page(", {} at {}: {}",
             at_bound.size() == 1 ? Page("1 parameter") : page("{} parameters", at_bound.size()),
             at_bound.size() == 1 ? "its bound" : "their bounds", joined(at_bound, ", "));
  }
  return text + "\n" + sentence_lines(message, detail);
}

Page status_lines(const Fit& fit, Detail detail) {
  return status_lines(fit.status, verbs::names_at_bound(fit), fit.message, detail);
}

}  // namespace sepcal::text
