// SPDX-License-Identifier: BSD-3-Clause
// The bytes of a file: hashed as they stand there, then unpacked where they are packed (gzip, RFC
// 1952; Zstandard, RFC 8878) and turned into UTF-8 where they are UTF-16.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace sepcal::files {

/// Bytes that come one after the other.
class Bytes {
 public:
  virtual ~Bytes() = default;

  /// How many came, at most `most`, which is 16 or more; none at the end alone.
  std::size_t read(char* to, std::size_t most);

  /// Those that come next, at least `count` of them but at the end; they stay to be read.
  std::string_view peek(std::size_t count);

 private:
  virtual std::size_t pull(char* to, std::size_t most) = 0;

  std::string ahead_;
  std::size_t given_ = 0;  // of ahead_
};

/// Where a file's own bytes have got to.
struct FileProgress {
  std::uint64_t read = 0;
  std::uint64_t total = 0;  // zero where it is unknown, as for a pipe
  std::string sha256 = {};  // of all; empty before the end
};

class ByteSource {
 public:
  /// Throws Error where the file isn't there, is a folder or can't be read.
  explicit ByteSource(const std::string& file);
  ~ByteSource();

  /// As Bytes::read(), and it heeds a stop. Throws Error where the file can't be read, is damaged,
  /// or unpacks to more than 1 GiB and a hundred times its size.
  std::size_t read(char* to, std::size_t most);

  /// At least `count` bytes that come next, but at the end.
  std::string_view peek(std::size_t count);

  const FileProgress& progress() const { return progress_; }

  /// "UTF-16" where that was turned into UTF-8; empty otherwise.
  std::string_view encoding() const { return encoding_; }

 private:
  std::string file_;
  FileProgress progress_;
  std::unique_ptr<Bytes> bytes_;
  std::string_view encoding_;
  bool packed_ = false;
  std::uint64_t unpacked_ = 0;
};

}  // namespace sepcal::files
