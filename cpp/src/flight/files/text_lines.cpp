// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/text_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "base/utf8.hpp"
#include "sepcal/error.hpp"

namespace sepcal::files {
namespace {

constexpr std::size_t buffer_size = text_chunk + longest_line;
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

/// Of all bytes, together.
unsigned char classes_of(std::string_view text) {
  unsigned char seen = plain;
  for (const char c : text) seen |= byte_classes[static_cast<unsigned char>(c)];
  return seen;
}

/// LF, or CR where there is no other.
char find_line_end(std::string_view text) {
  const bool is_old_mac =
      text.find('\n') == std::string_view::npos && text.find('\r') != std::string_view::npos;
  return is_old_mac ? '\r' : '\n';
}

}  // namespace

bool has_control(std::string_view line) { return (classes_of(line) & control) != 0; }

bool is_utf8(std::string_view text) { return find_invalid_utf8(text) == text.size(); }

bool may_be_windows(std::string_view text) {
  return text.find_first_of("\x81\x8D\x8F\x90\x9D") == std::string_view::npos;
}

std::string to_utf8(std::string_view text) {
  if (is_utf8(text)) return std::string(text);
  // Windows-1252 from 0x80 to 0x9F; what it leaves open is the control of that number.
  constexpr std::array<char16_t, 32> windows{
      0x20AC, 0x81,   0x201A, 0x0192, 0x201E, 0x2026, 0x2020, 0x2021, 0x02C6, 0x2030, 0x0160,
      0x2039, 0x0152, 0x8D,   0x017D, 0x8F,   0x90,   0x2018, 0x2019, 0x201C, 0x201D, 0x2022,
      0x2013, 0x2014, 0x02DC, 0x2122, 0x0161, 0x203A, 0x0153, 0x9D,   0x017E, 0x0178};
  std::string utf8;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const unsigned code = byte < 0x80 || byte >= 0xA0 ? byte : windows.at(byte - 0x80U);
    if (code < 0x80) {
      utf8 += c;
    } else if (code < 0x800) {
      utf8 += static_cast<char>(0xC0U | (code >> 6U));
      utf8 += static_cast<char>(0x80U | (code & 0x3FU));
    } else {
      utf8 += static_cast<char>(0xE0U | (code >> 12U));
      utf8 += static_cast<char>(0x80U | ((code >> 6U) & 0x3FU));
      utf8 += static_cast<char>(0x80U | (code & 0x3FU));
    }
  }
  return utf8;
}

TextLines::TextLines(const std::string& file, Progress progress)
    : file_(file),
      progress_(std::move(progress)),
      source_(file),
      buffer_(std::make_unique_for_overwrite<char[]>(buffer_size)),  // NOLINT
      ahead_(std::make_unique_for_overwrite<char[]>(text_chunk)) {}

std::optional<std::string_view> TextLines::next() {
  std::size_t searched = 0;
  const char* end = nullptr;
  for (;;) {
    const char* from = buffer_.get() + first_ + searched;
    searched = last_ - first_;
    end = static_cast<const char*>(
        std::memchr(from, '\n', static_cast<std::size_t>(buffer_.get() + last_ - from)));
    if (end != nullptr || source_ended_ || searched >= longest_line) break;
    fill();
  }
  if (end == nullptr && searched == 0) return std::nullopt;
  was_cut_ = end == nullptr;

  const char* begin = buffer_.get() + first_;
  const auto length = end != nullptr ? static_cast<std::size_t>(end - begin) : searched;
  if (length >= longest_line) refuse_length();
  const std::uint64_t offset = bytes_read_ - searched;
  std::string_view text(begin, length);
  first_ += text.size() + (end != nullptr ? 1 : 0);
  ++line_;
  while (text.ends_with('\r')) text.remove_suffix(1);
  check_text(text, offset);
  if (line_ == 1 && text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  return text;
}

std::string_view TextLines::peek() {
  for (;;) {
    const std::string_view text(buffer_.get() + first_, last_ - first_);
    if (source_ended_) return text;
    if (text.size() >= text_chunk) return text.substr(0, text.rfind('\n') + 1);
    fill();
  }
}

void TextLines::skip(std::size_t bytes, std::size_t lines) {
  first_ += bytes;
  line_ += lines;
}

void TextLines::read_ahead() {
  if (source_ended_ || ahead_first_ < ahead_last_) return;
  ahead_first_ = 0;
  ahead_last_ = read(ahead_.get(), text_chunk);
}

void TextLines::fill() {
  std::copy(buffer_.get() + first_, buffer_.get() + last_, buffer_.get());
  last_ -= first_;
  first_ = 0;
  read_ahead();
  const std::size_t count = std::min(ahead_last_ - ahead_first_, buffer_size - last_);
  std::copy_n(ahead_.get() + ahead_first_, count, buffer_.get() + last_);
  ahead_first_ += count;
  last_ += count;
  bytes_read_ += count;
  source_ended_ = ahead_first_ == ahead_last_ && all_read_;
  const FileProgress& read = source_.progress();
  if (progress_ && read.total > 0) {
    progress_(std::min(1.0, static_cast<double>(read.read) / static_cast<double>(read.total)));
  }
}

/// How many bytes came, less NULs behind the last of others.
std::size_t TextLines::read(char* to, std::size_t most) {
  while (!all_read_) {
    const std::size_t count = source_.read(to, most);
    all_read_ = count == 0;
    const std::size_t text = std::string_view(to, count).find_last_not_of('\0') + 1;
    if (text > 0 && nuls_ > 0) {
      throw Error(fmt::format("{}: {} NUL bytes stand between its lines; is this a CSV file?",
                              file_, nuls_));
    }
    nuls_ += count - text;
    if (text == 0) continue;
    if (line_end_ == 0) line_end_ = find_line_end({to, text});
    if (line_end_ == '\r') std::replace(to, to + text, '\r', '\n');
    return text;
  }
  return 0;
}

void TextLines::refuse_length() {
  ++line_;
  check_text({buffer_.get() + first_, longest_line}, bytes_read_ - (last_ - first_));
  fail("is longer than 1 MiB; is this a CSV file?");
}

void TextLines::check_text(std::string_view text, std::uint64_t offset) const {
  if (!has_control(text)) return;
  const auto first_control = std::ranges::find_if(
      text, [](char c) { return byte_classes[static_cast<unsigned char>(c)] == control; });
  const auto at = static_cast<std::size_t>(first_control - text.begin());
  if (text[at] == '\r') {
    fail("a carriage return inside the line; end lines with LF or CRLF");
  }
  fail(fmt::format("byte 0x{:02x} (byte {} of the file) is no text; is this a CSV file?",
                   static_cast<unsigned char>(text[at]), offset + at));
}

void TextLines::fail(const std::string& message) const {
  throw Error(fmt::format("{} line {}: {}", file_, line_, message));
}

}  // namespace sepcal::files
