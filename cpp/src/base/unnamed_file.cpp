// SPDX-License-Identifier: BSD-3-Clause
#include "base/unnamed_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>

namespace sepcal::base {
namespace {

#ifdef O_TMPFILE
int open_unnamed(const std::string& folder, int how, mode_t mode) {
  return ::open(folder.c_str(), O_TMPFILE | O_CLOEXEC | how, mode);  // NOLINT(*-vararg)
}
#else
int open_unnamed(const std::string& /*folder*/, int /*how*/, mode_t /*mode*/) {
  errno = EOPNOTSUPP;
  return -1;
}
#endif

/// How Linux names an open file that has no name of its own.
std::string path_of(int descriptor) { return "/proc/self/fd/" + std::to_string(descriptor); }

}  // namespace

std::string temporary_folder() {
  const char* folder = std::getenv("TMPDIR");  // NOLINT(concurrency-mt-unsafe)
  return folder != nullptr && *folder != '\0' ? folder : "/tmp";
}

int open_scratch_file(const std::string& folder) {
  const int unnamed = open_unnamed(folder, O_RDWR, 0600);
  if (unnamed >= 0 || (errno != EOPNOTSUPP && errno != EISDIR)) return unnamed;
  std::string name = folder + "/sepcal-XXXXXX";
  const int named = ::mkstemp(name.data());
  if (named < 0) return named;
  ::unlink(name.c_str());
  ::fcntl(named, F_SETFD, FD_CLOEXEC);  // NOLINT(*-vararg)
  return named;
}

int open_unnamed_file(const std::string& folder, mode_t mode) {
  const int descriptor = open_unnamed(folder, O_WRONLY, mode);
  if (descriptor < 0 || ::access(path_of(descriptor).c_str(), F_OK) == 0) return descriptor;
  ::close(descriptor);
  return -1;
}

bool name_file(int descriptor, const char* name) {
  return ::linkat(AT_FDCWD, path_of(descriptor).c_str(), AT_FDCWD, name, AT_SYMLINK_FOLLOW) == 0;
}

}  // namespace sepcal::base
