// SPDX-License-Identifier: BSD-3-Clause
#include "sepcal/detail/flight/output_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <list>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/unnamed_file.hpp"
#include "sepcal/error.hpp"

namespace sepcal {
namespace {

constexpr std::size_t buffer_size = std::size_t{1} << 16U;
constexpr mode_t before_umask = 0666;
constexpr mode_t permissions = 07777;

/// Where a chain of symbolic links ends, whether or not a file is there.
std::filesystem::path follow_links(std::filesystem::path path) {
  constexpr int longest_chain = 40;  // Linux's own limit
  std::error_code ignored;
  for (int i = 0; i < longest_chain && std::filesystem::is_symlink(path, ignored); ++i) {
    path = path.parent_path() / std::filesystem::read_symlink(path, ignored);
  }
  return path;
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : ".";
}

/// Throws Error where the name promises another form than text.
void check_name(const std::filesystem::path& file) {
  constexpr std::array<std::string_view, 13> others{
      ".xlsx", ".xls",  ".parquet", ".feather", ".arrow", ".mat", ".h5",
      ".hdf5", ".mcap", ".nc",      ".gz",      ".zst",   ".ulg"};
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return std::tolower(c); });
  if (std::ranges::find(others, extension) == others.end()) return;
  throw Error(
      fmt::format("{}: what is written is text, which no {} file is; give another name, as "
                  "{}.csv",
                  file.string(), extension, file.stem().string()));
}

}  // namespace

OutputFile::OutputFile(std::filesystem::path target)
    : named_(std::move(target)), target_(follow_links(named_)), stream_(this) {
  check_name(named_);
  pending_.reserve(buffer_size);
  if (named_ == "/dev/stdout") {  // after what is there, and not in the place of a file behind it
    direct_ = true;
    descriptor_ = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 0);
    if (descriptor_ < 0) fail("can't be written", errno);
    return;
  }
  struct stat old{};
  if (::stat(named_.c_str(), &old) != 0) {
    if (errno == ELOOP) fail("is a loop of symbolic links; name a file", 0);
    if (errno != ENOENT && errno != ENOTDIR) fail("can't be written", errno);
    if (!named_.has_filename()) fail("names no file; end the path with a file's name", 0);
    open_beside_target();
    return;
  }
  if (S_ISDIR(old.st_mode)) fail("is a folder; name a file in it", 0);
  if (!S_ISREG(old.st_mode)) {
    direct_ = true;
    descriptor_ = ::open(named_.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) fail("can't be written", errno);
    return;
  }
  if (::faccessat(AT_FDCWD, target_.c_str(), W_OK, AT_EACCESS) != 0)
    fail("can't be written", errno);
  open_beside_target();
  // The owner can be kept by root alone; for anyone else the file becomes the writer's own.
  if (::fchown(descriptor_, old.st_uid, old.st_gid) != 0 && errno != EPERM) {
    fail("can't keep its owner", errno);
  }
  if (::fchmod(descriptor_, old.st_mode & permissions) != 0) {
    fail("can't keep its permissions", errno);
  }
}

OutputFile::~OutputFile() { abandon(); }

void OutputFile::open_beside_target() {
  const auto folder = folder_of(target_);
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored)) {
    fail(fmt::format("folder '{}' isn't there; make it first", folder.string()), 0);
  }
  descriptor_ = base::open_unnamed_file(folder, before_umask);
  if (descriptor_ >= 0) return;
  const auto create = [this](const char* hidden) {
    descriptor_ = ::open(hidden, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, before_umask);
    return descriptor_ >= 0;
  };
  take_hidden_name(create, "can't be written");
}

/// Sets hidden_ to the first free name; `take` makes the file of that name or leaves errno.
template <class Take>
void OutputFile::take_hidden_name(const Take& take, const char* failure) {
  for (int attempt = 0;; ++attempt) {
    auto name = folder_of(target_) / fmt::format(".sepcal-{}-{}.part", ::getpid(), attempt);
    if (take(name.c_str())) {
      hidden_ = std::move(name);  // a copy could find no memory, and nobody would remove the file
      return;
    }
    if (errno != EEXIST) fail(failure, errno);
  }
}

void OutputFile::write(std::string_view text) {
  if (sputn(text.data(), static_cast<std::streamsize>(text.size())) !=
      static_cast<std::streamsize>(text.size())) {
    fail("writing failed", error_);
  }
}

void OutputFile::flush() {
  if (descriptor_ < 0) throw Error(named_.string() + ": was written already");
  if (error_ != 0 || !send_pending()) fail("writing failed", error_);
  // Where the file reaches the disc only after the rename, a power cut leaves an empty one.
  if (!direct_ && ::fsync(descriptor_) != 0) fail("writing failed", errno);
}

void OutputFile::commit() {
  flush();
  if (!direct_ && hidden_.empty()) {
    const auto link = [this](const char* hidden) { return base::name_file(descriptor_, hidden); };
    take_hidden_name(link, "can't be put in place");
  }
  if (::close(std::exchange(descriptor_, -1)) != 0) fail("writing failed", errno);
  if (!direct_ && ::rename(hidden_.c_str(), target_.c_str()) != 0) {
    fail("can't be put in place", errno);
  }
  hidden_.clear();
}

std::streamsize OutputFile::xsputn(const char* text, std::streamsize count) {
  if (error_ != 0 || descriptor_ < 0) return 0;
  pending_.insert(pending_.end(), text, text + count);
  return pending_.size() < buffer_size || send_pending() ? count : 0;
}

OutputFile::int_type OutputFile::overflow(int_type c) {
  const char character = traits_type::to_char_type(c);
  return xsputn(&character, 1) == 1 ? c : traits_type::eof();
}

/// Hands the pending bytes to the system; false, with error_ set, where it doesn't take them.
bool OutputFile::send_pending() {
  for (std::size_t sent = 0; sent < pending_.size();) {
    const auto count = ::write(descriptor_, pending_.data() + sent, pending_.size() - sent);
    if (count < 0 && errno != EINTR) {
      error_ = errno;
      return false;
    }
    if (count > 0) sent += static_cast<std::size_t>(count);
  }
  pending_.clear();
  return true;
}

void OutputFile::abandon() noexcept {
  if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
  if (!hidden_.empty()) ::unlink(hidden_.c_str());
  hidden_.clear();
}

void OutputFile::fail(const std::string& what, int error) {
  abandon();
  throw Error(error == 0 ? fmt::format("{}: {}", named_.string(), what)
                         : fmt::format("{}: {}: {}", named_.string(), what, std::strerror(error)));
}

void write_whole(const std::map<std::string, std::string>& texts) {
  std::list<OutputFile> files;
  for (const auto& [file, text] : texts) files.emplace_back(file).write(text);
  for (OutputFile& file : files) file.flush();
  for (OutputFile& file : files) file.commit();
}

bool is_same_file(const std::filesystem::path& one, const std::filesystem::path& other) {
  std::error_code ignored;
  if (std::filesystem::equivalent(one, other, ignored)) return true;
  const auto first = std::filesystem::weakly_canonical(follow_links(one), ignored);
  return !first.empty() && first == std::filesystem::weakly_canonical(follow_links(other), ignored);
}

void check_not_input(const std::filesystem::path& output, const std::filesystem::path& input) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(input, ignored) || !is_same_file(output, input)) return;
  throw Error(fmt::format("{}: it is an input, and writing there would lose it; name another file",
                          output.string()));
}

}  // namespace sepcal
