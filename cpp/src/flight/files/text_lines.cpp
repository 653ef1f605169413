// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/text_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "base/utf8.hpp"
#include "sepcal/error.hpp"

namespace sepcal::files {
namespace {

constexpr std::size_t chunk = std::size_t{1} << 20U;  // bytes read at a time, and the longest line
constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

enum ByteClass : unsigned char { plain = 0, control = 1, multibyte = 2 };

constexpr std::array<unsigned char, 256> byte_classes = [] {
  std::array<unsigned char, 256> classes{};
  for (std::size_t byte = 0; byte < 0x20; ++byte) classes[byte] = control;
  classes['\t'] = plain;
  classes[0x7F] = control;
  for (std::size_t byte = 0x80; byte < 0x100; ++byte) classes[byte] = multibyte;
  return classes;
}();

/// Index of the first byte that is not UTF-8, or text.size().
std::size_t find_invalid_utf8(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = base::utf8_length(text, at);
    if (length == 0) return at;
    at += length;
  }
  return text.size();
}

}  // namespace

TextLines::TextLines(const std::string& file, Progress progress)
    : file_(file), progress_(std::move(progress)), buffer_(chunk) {
  std::error_code ignored;
  const auto status = std::filesystem::status(file, ignored);
  if (status.type() == std::filesystem::file_type::not_found) {
    throw Error(file + ": no such file");
  }
  if (std::filesystem::is_directory(status)) {
    throw Error(file + ": is a folder; name a CSV file in it");
  }
  stream_.reset(std::fopen(file.c_str(), "rb"));
  if (!stream_) throw Error(file + ": can't be read: " + std::strerror(errno));
  std::setvbuf(stream_.get(), nullptr, _IONBF, 0);
  if (std::filesystem::is_regular_file(status)) {
    const auto size = std::filesystem::file_size(file, ignored);
    if (!ignored) bytes_total_ = size;
  }
}

std::optional<std::string_view> TextLines::next() {
  std::size_t searched = 0;
  const char* end = nullptr;
  for (;;) {
    const char* from = buffer_.data() + first_ + searched;
    searched = last_ - first_;
    end = static_cast<const char*>(
        std::memchr(from, '\n', static_cast<std::size_t>(buffer_.data() + last_ - from)));
    if (end != nullptr || stream_ended_) break;
    fill();
  }
  if (end == nullptr && searched == 0) return std::nullopt;

  const char* begin = buffer_.data() + first_;
  const std::uint64_t offset = bytes_read_ - searched;
  std::string_view text(begin, end != nullptr ? static_cast<std::size_t>(end - begin) : searched);
  first_ += text.size() + (end != nullptr ? 1 : 0);
  ++line_;
  if (text.ends_with('\r')) text.remove_suffix(1);
  check_text(text, offset);
  if (line_ == 1 && text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  return text;
}

void TextLines::fill() {
  std::copy(buffer_.data() + first_, buffer_.data() + last_, buffer_.data());
  last_ -= first_;
  first_ = 0;
  if (last_ == buffer_.size()) {
    ++line_;
    check_text({buffer_.data(), last_}, bytes_read_ - last_);
    fail("is longer than 1 MiB; is this a CSV file?");
  }
  errno = 0;
  const std::size_t count =
      std::fread(buffer_.data() + last_, 1, buffer_.size() - last_, stream_.get());
  if (std::ferror(stream_.get()) != 0) {
    throw Error(file_ + ": can't be read: " + std::strerror(errno));
  }
  hash_.absorb(buffer_.data() + last_, count);
  last_ += count;
  bytes_read_ += count;
  if (std::feof(stream_.get()) != 0) {
    stream_ended_ = true;
    digest_ = hash_.finish();
  }
  if (progress_ && bytes_total_ > 0) {
    progress_(std::min(1.0, static_cast<double>(bytes_read_) / static_cast<double>(bytes_total_)));
  }
}

void TextLines::check_text(std::string_view text, std::uint64_t offset) const {
  unsigned char seen = plain;
  for (const char c : text) seen |= byte_classes[static_cast<unsigned char>(c)];
  if (seen == plain) return;
  const auto first_control = std::ranges::find_if(
      text, [](char c) { return byte_classes[static_cast<unsigned char>(c)] == control; });
  const auto at =
      std::min(static_cast<std::size_t>(first_control - text.begin()), find_invalid_utf8(text));
  if (at == text.size()) return;
  if (text[at] == '\r') {
    fail("a carriage return inside the line; end lines with LF or CRLF");
  }
  fail(fmt::format("byte 0x{:02x} (byte {} of the file) is no UTF-8 text; is this a CSV file?",
                   static_cast<unsigned char>(text[at]), offset + at));
}

void TextLines::fail(const std::string& message) const {
  throw Error(fmt::format("{} line {}: {}", file_, line_, message));
}

}  // namespace sepcal::files
