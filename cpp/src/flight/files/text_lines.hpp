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

class TextLines {
 public:
  /// Throws Error where the file isn't there, is a folder or can't be read.
  TextLines(const std::string& file, Progress progress);

  /// The next line without its line end (LF, CRLF or the file's end) and without a byte-order mark;
  /// nothing at the end. Valid until the next call. Throws Error for control bytes, text that is
  /// not UTF-8 and a line over 1 MiB.
  std::optional<std::string_view> next();

  /// Number of the line that next() gave last, counted from 1.
  std::size_t line() const { return line_; }

  bool at_end() const { return !digest_.empty(); }

  /// Of all bytes; empty before the end.
  const std::string& sha256() const { return digest_; }

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  void fill();
  void check_text(std::string_view text, std::uint64_t offset) const;
  [[noreturn]] void fail(const std::string& message) const;

  std::string file_;
  Progress progress_;
  std::unique_ptr<std::FILE, CloseFile> stream_;
  std::vector<char> buffer_;
  std::size_t first_ = 0;  // bytes [first_, last_) of the buffer are still to be handed out
  std::size_t last_ = 0;
  std::uint64_t bytes_read_ = 0;
  std::uint64_t bytes_total_ = 0;  // zero where unknown, as for a pipe
  bool stream_ended_ = false;
  std::size_t line_ = 0;
  Sha256 hash_;
  std::string digest_;
};

}  // namespace sepcal::files
