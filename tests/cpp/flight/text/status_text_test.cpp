// SPDX-License-Identifier: BSD-3-Clause
// A fit's message as the lines of a page: short, the worst first, the rest where it is asked for.
#include "flight/text/status_text.hpp"

#include <doctest/doctest.h>

namespace status_text_test {

using sepcal::Detail;
using sepcal::FitStatus;
using sepcal::text::sentence_lines;
using sepcal::text::sentences;
using sepcal::text::status_lines;
using Sentences = std::vector<std::string>;

namespace {

const std::string long_reason(80, 'x');

}  // namespace

TEST_CASE("a message is cut into its sentences, the worst first") {
  CHECK(sentences("").empty());
  CHECK(sentences("one thing") == Sentences{"one thing"});
  CHECK(sentences("projected fell back to joint, because it did not converge; a and b are hard to "
                  "tell apart: a has a standard error of 2; 'c' came out as 9, far from what is "
                  "known of it, 1 +- 1; d and e can't be told apart: only d - e is determined; and "
                  "3 more (see unobservable and weak)") ==
        Sentences{"d and e can't be told apart: only d - e is determined",
                  "'c' came out as 9, far from what is known of it, 1 +- 1",
                  "a and b are hard to tell apart: a has a standard error of 2",
                  "projected fell back to joint, because it did not converge",
                  "and 3 more (see unobservable and weak)"});
}

TEST_CASE("sentences of one kind keep their order") {
  CHECK(sentences("b; a; c") == Sentences{"b", "a", "c"});
}

TEST_CASE("a brief page has three sentences, each within a line") {
  CHECK(sentence_lines("", Detail::brief).text() == "");
  CHECK(sentence_lines("a; b; c", Detail::brief).text() == "  a\n  b\n  c\n");
  CHECK(sentence_lines("a; b; c; d", Detail::brief).text() ==
        "  a\n  b\n  c\n  ... more with --explain\n");
  const std::string sentence = "a and b are hard to tell apart: " + long_reason;
  CHECK(sentence_lines(sentence, Detail::brief).text() ==
        "  a and b are hard to tell apart\n  ... more with --explain\n");
  CHECK(sentence_lines("short: " + long_reason, Detail::brief).text() ==
        "  short: " + long_reason + "\n");
}

TEST_CASE("explained, everything is there") {
  const std::string sentence = "a and b are hard to tell apart: " + long_reason;
  CHECK(sentence_lines("a; b; c; d; " + sentence, Detail::explained).text() ==
        "  a\n  b\n  c\n  d\n  " + sentence + "\n");
}

TEST_CASE("the status counts and names the parameters at their bounds") {
  CHECK(status_lines(FitStatus::converged, {}, "", Detail::brief).text() == "status: converged\n");
  CHECK(status_lines(FitStatus::not_converged, {"a"}, "b", Detail::brief).text() ==
        "status: not_converged, 1 parameter at its bound: a\n  b\n");
  CHECK(status_lines(FitStatus::not_identifiable, {"a", "b"}, "", Detail::brief).text() ==
        "status: not_identifiable, 2 parameters at their bounds: a, b\n");
}

}  // namespace status_text_test
