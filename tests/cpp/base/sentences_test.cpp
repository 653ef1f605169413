// SPDX-License-Identifier: BSD-3-Clause
// Sentences become a message and a message its sentences.
#include "base/sentences.hpp"

#include <doctest/doctest.h>

namespace sentences_test {

using sepcal::base::join_sentences;
using sepcal::base::one_sentence;
using sepcal::base::split_sentences;
using Sentences = std::vector<std::string>;

TEST_CASE("a message is its sentences, one behind the other") {
  CHECK(join_sentences({}).empty());
  CHECK(join_sentences({"a"}) == "a");
  CHECK(join_sentences({"a", "b: c", "d"}) == "a; b: c; d");
  CHECK(join_sentences({"", "a", "", "b", ""}) == "a; b");
  CHECK(join_sentences({join_sentences({"a", "b"}), "c"}) == "a; b; c");
}

TEST_CASE("a name with a semicolon ends no sentence") {
  CHECK(one_sentence("a can't be seen") == "a can't be seen");
  CHECK(one_sentence("s.turn; left and s.turn;right; b") == "s.turn, left and s.turn;right, b");
}

TEST_CASE("a message is cut where its sentences were joined") {
  CHECK(split_sentences("").empty());
  for (const Sentences& sentences : {Sentences{"a"}, Sentences{"a", "b: c", "d"}}) {
    CHECK(split_sentences(join_sentences(sentences)) == sentences);
  }
}

}  // namespace sentences_test
