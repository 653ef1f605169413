// SPDX-License-Identifier: BSD-3-Clause
#include "base/sentences.hpp"

#include <algorithm>

namespace sepcal::base {
namespace {

constexpr std::string_view between = "; ";

}  // namespace

std::string one_sentence(std::string text) {
  for (std::size_t at = 0; (at = text.find(between, at)) != std::string::npos;) text[at] = ',';
  return text;
}

std::string join_sentences(const std::vector<std::string>& sentences) {
  std::string message;
  for (const std::string& sentence : sentences) {
    if (sentence.empty()) continue;
    if (!message.empty()) message += between;
    message += sentence;
  }
  return message;
}

std::vector<std::string> split_sentences(std::string_view message) {
  std::vector<std::string> sentences;
  for (std::size_t at = 0; at < message.size();) {
    const std::size_t end = std::min(message.find(between, at), message.size());
    sentences.emplace_back(message.substr(at, end - at));
    at = end + between.size();
  }
  return sentences;
}

}  // namespace sepcal::base
