// SPDX-License-Identifier: BSD-3-Clause
// A file that appears whole or not at all: what is written goes to a file without a name on the
// target's disc, and commit() puts it in the target's place in one step (POSIX rename). Until then,
// and after any failure or end of the process, the target is what it was and nothing else is there.
#pragma once

#include <filesystem>
#include <map>
#include <ostream>
#include <streambuf>
#include <string>
#include <string_view>
#include <vector>

namespace sepcal {

class OutputFile : private std::streambuf {
 public:
  /// Opens the nameless file (Linux's O_TMPFILE; where the disc has none, a hidden one beside the
  /// target), so that a target that can't be written is known before the long work.
  /// A symbolic link is followed; a device, a pipe and /dev/stdout are written directly. Throws
  /// Error where the target's folder isn't there, the target is a folder or a loop of symbolic
  /// links, or writing isn't permitted.
  explicit OutputFile(std::filesystem::path target);
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  /// Without commit(), nothing is left of what was written.
  ~OutputFile() override;

  /// Throws Error where the bytes can't be written: a full disc, a quota.
  void write(std::string_view text);

  /// The same as a stream. What fails here is thrown by commit().
  std::ostream& stream() { return stream_; }

  /// Brings all that was written to the disc. Two results appear both or not at all where both are
  /// flushed before either is committed. Throws Error where any write failed.
  void flush();

  /// flush(), and into the target's place, with the permissions that the target had, or those that
  /// the umask leaves. Throws Error where that fails.
  void commit();

 private:
  std::streamsize xsputn(const char* text, std::streamsize count) override;
  int_type overflow(int_type c) override;

  void open_beside_target();
  template <class Take>
  void take_hidden_name(const Take& take, const char* failure);
  bool send_pending();
  void abandon() noexcept;
  [[noreturn]] void fail(const std::string& what, int error);

  std::filesystem::path named_;   // as the user gave it, for messages
  std::filesystem::path target_;  // behind symbolic links
  std::filesystem::path hidden_;  // beside the target; empty while the file has no name
  bool direct_ = false;           // a device or pipe: there is nothing to put in place
  int descriptor_ = -1;
  int error_ = 0;  // errno of the first write that failed
  std::vector<char> pending_;
  std::ostream stream_;
};

/// Writes {file: text}; throws Error, with nothing written or altered, where one can't be written.
void write_whole(const std::map<std::string, std::string>& texts);

/// Whether both paths lead to one file, by whatever names and links; it need not be there yet.
bool is_same_file(const std::filesystem::path& one, const std::filesystem::path& other);

/// Throws Error where `output` is the file that `input` is read from: writing would lose it.
void check_not_input(const std::filesystem::path& output, const std::filesystem::path& input);

}  // namespace sepcal
