// SPDX-License-Identifier: BSD-3-Clause
// A file that appears whole or not at all: what is written goes to a hidden file beside the target,
// and commit() puts it in the target's place in one step (POSIX rename). Until then, and after any
// failure, the target is what it was.
#pragma once

#include <filesystem>
#include <ostream>
#include <streambuf>
#include <string>
#include <string_view>
#include <vector>

namespace sepcal {

class OutputFile : private std::streambuf {
 public:
  /// Opens the hidden file, so that a target that can't be written is known before the long work.
  /// A symbolic link is followed; a device or pipe (/dev/stdout) is written directly. Throws Error
  /// where the target's folder isn't there, the target is a folder, or writing isn't permitted.
  explicit OutputFile(std::filesystem::path target);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Without commit(), removes the hidden file.
  ~OutputFile() override;

  /// Throws Error where the bytes can't be written: a full disc, a quota.
  void write(std::string_view text);

  /// The same as a stream. What fails here is thrown by commit().
  std::ostream& stream() { return stream_; }

  /// Brings all that was written to the disc and into the target's place, with the permissions that
  /// the target had, or those that the umask leaves. Throws Error where any write failed.
  void commit();

 private:
  std::streamsize xsputn(const char* text, std::streamsize count) override;
  int_type overflow(int_type c) override;

  void open_beside_target();
  bool flush();
  void abandon() noexcept;
  [[noreturn]] void fail(const std::string& what, int error);

  std::filesystem::path named_;   // as the user gave it, for messages
  std::filesystem::path target_;  // behind symbolic links
  std::filesystem::path hidden_;  // empty where the target is written directly
  int descriptor_ = -1;
  int error_ = 0;  // errno of the first write that failed
  std::vector<char> pending_;
  std::ostream stream_;
};

}  // namespace sepcal
