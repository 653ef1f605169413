// SPDX-License-Identifier: BSD-3-Clause
#include "flight/files/text_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "base/stop.hpp"
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

}  // namespace

bool is_text(std::string_view line) {
  const unsigned char seen = classes_of(line);
  if (seen == plain) return true;
  return (seen & control) == 0 && find_invalid_utf8(line) == line.size();
}

TextLines::TextLines(const std::string& file, Progress progress)
    : file_(file),
      progress_(std::move(progress)),
      buffer_(std::make_unique_for_overwrite<char[]>(buffer_size)),  // NOLINT
      ahead_(std::make_unique_for_overwrite<char[]>(text_chunk)) {
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
    const char* from = buffer_.get() + first_ + searched;
    searched = last_ - first_;
    end = static_cast<const char*>(
        std::memchr(from, '\n', static_cast<std::size_t>(buffer_.get() + last_ - from)));
    if (end != nullptr || stream_ended_ || searched >= longest_line) break;
    fill();
  }
  if (end == nullptr && searched == 0) return std::nullopt;

  const char* begin = buffer_.get() + first_;
  const auto length = end != nullptr ? static_cast<std::size_t>(end - begin) : searched;
  if (length >= longest_line) refuse_length();
  const std::uint64_t offset = bytes_read_ - searched;
  std::string_view text(begin, length);
  first_ += text.size() + (end != nullptr ? 1 : 0);
  ++line_;
  if (text.ends_with('\r')) text.remove_suffix(1);
  check_text(text, offset);
  if (line_ == 1 && text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  return text;
}

std::string_view TextLines::peek() {
  for (;;) {
    const std::string_view text(buffer_.get() + first_, last_ - first_);
    if (stream_ended_) return text;
    if (text.size() >= text_chunk) return text.substr(0, text.rfind('\n') + 1);
    fill();
  }
}

void TextLines::skip(std::size_t bytes, std::size_t lines) {
  first_ += bytes;
  line_ += lines;
}

void TextLines::read_ahead() {
  if (stream_ended_ || ahead_first_ < ahead_last_) return;
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
  stream_ended_ = ahead_first_ == ahead_last_ && at_end();
  if (progress_ && bytes_total_ > 0) {
    progress_(std::min(1.0, static_cast<double>(bytes_read_) / static_cast<double>(bytes_total_)));
  }
}

/// How many bytes came. A signal that interrupts is a time to ask.
std::size_t TextLines::read(char* to, std::size_t most) {
  if (at_end()) return 0;
  for (;;) {
    base::heed_stop();
    errno = 0;
    const std::size_t count = std::fread(to, 1, most, stream_.get());
    const int error = errno;
    if (std::ferror(stream_.get()) != 0) {
      if (error != EINTR) throw Error(file_ + ": can't be read: " + std::strerror(error));
      std::clearerr(stream_.get());
      if (count == 0) continue;
    }
    hash_.absorb(to, count);
    if (std::feof(stream_.get()) != 0) digest_ = hash_.finish();
    return count;
  }
}

void TextLines::refuse_length() {
  ++line_;
  check_text({buffer_.get() + first_, longest_line}, bytes_read_ - (last_ - first_));
  fail("is longer than 1 MiB; is this a CSV file?");
}

void TextLines::check_text(std::string_view text, std::uint64_t offset) const {
  if (is_text(text)) return;
  const auto first_control = std::ranges::find_if(
      text, [](char c) { return byte_classes[static_cast<unsigned char>(c)] == control; });
  const auto at =
      std::min(static_cast<std::size_t>(first_control - text.begin()), find_invalid_utf8(text));
  if (at == text.size()) return;
  if (text[at] == '\r') {
    fail("a carriage return inside the line; end lines with LF or CRLF");
  }
  for (const auto& [opening, format] : {std::pair{"\xa3\x95", "DataFlash"}, {"ULog", "ULog"}}) {
    if (offset > 0 || !text.starts_with(opening)) continue;
    fail(fmt::format(
        "this is an autopilot's log ({}), no CSV file; convert it: python -m sepcal log "
        "{} -o flight.csv",
        format, file_));
  }
  fail(fmt::format("byte 0x{:02x} (byte {} of the file) is no UTF-8 text; is this a CSV file?",
                   static_cast<unsigned char>(text[at]), offset + at));
}

void TextLines::fail(const std::string& message) const {
  throw Error(fmt::format("{} line {}: {}", file_, line_, message));
}

}  // namespace sepcal::files
