// SPDX-License-Identifier: BSD-3-Clause
// The lines of a text file, read in chunks; refuses what no text has.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "flight/files/byte_source.hpp"
#include "sepcal/flight/csv.hpp"

namespace sepcal::files {

inline constexpr std::size_t text_chunk = std::size_t{2} << 20U;    // bytes read at a time
inline constexpr std::size_t longest_line = std::size_t{1} << 20U;  // more bytes than any line has

/// Whether a line has bytes that no text has.
bool has_control(std::string_view line);

/// Whether no byte is one that Windows-1252 leaves open.
bool may_be_windows(std::string_view text);

/// The text where it is UTF-8; otherwise taken for Windows-1252, the common superset of Latin-1.
std::string to_utf8(std::string_view text);
bool is_utf8(std::string_view text);

class TextLines {
 public:
  /// Throws Error where the file isn't there, is a folder or can't be read.
  TextLines(const std::string& file, Progress progress);

  /// The next line without its line end (LF, CRLF, CR where the file has no LF, or the file's end)
  /// and without a byte-order mark; nothing at the end, which NUL bytes up to there are too. Valid
  /// until the next call. Throws Error for control bytes and for a line over 1 MiB.
  std::optional<std::string_view> next();

  /// Whole lines that come next, with their ends, as they stand in the file: about a chunk of them,
  /// not looked at yet. Empty at the end. Valid until the next call of anything but read_ahead().
  std::string_view peek();

  /// The file's first bytes, some hundred of them where it has as many; before all other calls.
  std::string_view first_bytes() { return source_.peek(512); }

  std::string_view encoding() const { return source_.encoding(); }

  /// How many NUL bytes stood at the file's end; known there.
  std::uint64_t nuls_at_end() const { return nuls_; }

  /// Whether the line that next() gave ended with the file and not with a line's end.
  bool was_cut() const { return was_cut_; }

  /// Goes past the first `bytes` of what peek() gave, `lines` whole lines.
  void skip(std::size_t bytes, std::size_t lines);

  /// Reads on while somebody else, in another thread, works on what peek() gave.
  void read_ahead();

  /// Number of the line that next() gave or skip() passed last, counted from 1.
  std::size_t line() const { return line_; }

  /// The file's length; zero where it is unknown, as for a pipe.
  std::uint64_t bytes() const { return source_.progress().total; }

  /// Of all bytes; empty before the end.
  const std::string& sha256() const { return source_.progress().sha256; }

 private:
  void fill();
  std::size_t read(char* to, std::size_t most);
  void check_text(std::string_view text, std::uint64_t offset) const;
  [[noreturn]] void refuse_length();
  [[noreturn]] void fail(const std::string& message) const;

  std::string file_;
  Progress progress_;
  ByteSource source_;
  std::unique_ptr<char[]> buffer_;  // NOLINT: of fixed size, and not filled with zeros
  std::size_t first_ = 0;  // bytes [first_, last_) of the buffer are still to be handed out
  std::size_t last_ = 0;
  std::uint64_t bytes_read_ = 0;
  bool source_ended_ = false;      // and all that was read ahead is in the buffer
  std::unique_ptr<char[]> ahead_;  // NOLINT
  std::size_t ahead_first_ = 0;    // bytes [ahead_first_, ahead_last_) come next
  std::size_t ahead_last_ = 0;
  std::size_t line_ = 0;
  bool all_read_ = false;
  char line_end_ = 0;  // '\n', or '\r' where the first chunk has no other; 0: not seen yet
  std::uint64_t nuls_ = 0;
  bool was_cut_ = false;
};

}  // namespace sepcal::files
