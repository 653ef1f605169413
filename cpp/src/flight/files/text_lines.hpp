// SPDX-License-Identifier: BSD-3-Clause
// The lines of a text file, read in chunks; hashes the bytes on the way and refuses what no text
// has.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "flight/files/sha256.hpp"
#include "sepcal/flight/csv.hpp"

namespace sepcal::files {

inline constexpr std::size_t text_chunk = std::size_t{2} << 20U;    // bytes read at a time
inline constexpr std::size_t longest_line = std::size_t{1} << 20U;  // more bytes than any line has

/// Whether a line has no control bytes and is UTF-8.
bool is_text(std::string_view line);

class TextLines {
 public:
  /// Throws Error where the file isn't there, is a folder or can't be read.
  TextLines(const std::string& file, Progress progress);

  /// The next line without its line end (LF, CRLF or the file's end) and without a byte-order mark;
  /// nothing at the end. Valid until the next call. Throws Error for control bytes, text that is
  /// not UTF-8 and a line over 1 MiB.
  std::optional<std::string_view> next();

  /// Whole lines that come next, with their ends, as they stand in the file: about a chunk of them,
  /// not looked at yet. Empty at the end. Valid until the next call of anything but read_ahead().
  std::string_view peek();

  /// Goes past the first `bytes` of what peek() gave, `lines` whole lines.
  void skip(std::size_t bytes, std::size_t lines);

  /// Reads on while somebody else, in another thread, works on what peek() gave.
  void read_ahead();

  /// Number of the line that next() gave or skip() passed last, counted from 1.
  std::size_t line() const { return line_; }

  /// The file's length; zero where it is unknown, as for a pipe.
  std::uint64_t bytes() const { return bytes_total_; }

  bool at_end() const { return !digest_.empty(); }

  /// Of all bytes; empty before the end.
  const std::string& sha256() const { return digest_; }

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  void fill();
  std::size_t read(char* to, std::size_t most);
  void check_text(std::string_view text, std::uint64_t offset) const;
  [[noreturn]] void refuse_length();
  [[noreturn]] void fail(const std::string& message) const;

  std::string file_;
  Progress progress_;
  std::unique_ptr<std::FILE, CloseFile> stream_;
  std::unique_ptr<char[]> buffer_;  // NOLINT: of fixed size, and not filled with zeros
  std::size_t first_ = 0;  // bytes [first_, last_) of the buffer are still to be handed out
  std::size_t last_ = 0;
  std::uint64_t bytes_read_ = 0;
  std::uint64_t bytes_total_ = 0;
  bool stream_ended_ = false;      // and all that was read ahead is in the buffer
  std::unique_ptr<char[]> ahead_;  // NOLINT
  std::size_t ahead_first_ = 0;    // bytes [ahead_first_, ahead_last_) come next
  std::size_t ahead_last_ = 0;
  std::size_t line_ = 0;
  Sha256 hash_;
  std::string digest_;
};

}  // namespace sepcal::files
