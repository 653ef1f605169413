// SPDX-License-Identifier: BSD-3-Clause
// An output appears whole or not at all.
#include "sepcal/detail/flight/output_file.hpp"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>

#include "sepcal/error.hpp"
#include "temporary_folder.hpp"

namespace output_file_test {

using doctest::Contains;
using sepcal::Error;
using sepcal::OutputFile;
using sepcal::test::read_bytes;
using sepcal::test::TemporaryFolder;

namespace {

std::size_t count_files(const std::filesystem::path& folder) {
  return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

mode_t mode_of(const std::filesystem::path& file) {
  struct stat status{};
  REQUIRE(::stat(file.c_str(), &status) == 0);
  return status.st_mode & 07777U;
}

/// Whether that disc can hold a file that no name leads to; else a hidden one stands in.
bool has_nameless_files(const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600);
  if (descriptor >= 0) ::close(descriptor);
  return descriptor >= 0;
}

/// A disc with room for `bytes` more in a file: beyond, writing fails and raises SIGXFSZ.
class SmallDisc {
 public:
  explicit SmallDisc(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &old_);
    const rlimit small{bytes, old_.rlim_max};
    REQUIRE(::setrlimit(RLIMIT_FSIZE, &small) == 0);
  }
  SmallDisc(const SmallDisc&) = delete;
  SmallDisc& operator=(const SmallDisc&) = delete;
  ~SmallDisc() {
    ::setrlimit(RLIMIT_FSIZE, &old_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  void (*handler_)(int);
  rlimit old_{};
};

/// An unprivileged user for root, so that permissions count.
class Unprivileged {
 public:
  Unprivileged() : root_(::geteuid() == 0) {
    if (root_) REQUIRE(::seteuid(65534) == 0);
  }
  Unprivileged(const Unprivileged&) = delete;
  Unprivileged& operator=(const Unprivileged&) = delete;
  ~Unprivileged() {
    if (root_ && ::seteuid(0) != 0) std::abort();
  }

 private:
  bool root_;
};

}  // namespace

TEST_CASE("nothing is there before commit, all of it after") {
  const TemporaryFolder folder;
  const auto target = folder.path() / "base.json";
  OutputFile output(target);
  output.write("one ");
  output.stream() << "two " << 3;
  CHECK_FALSE(std::filesystem::exists(target));
  output.commit();
  CHECK(read_bytes(target) == "one two 3");
  CHECK(count_files(folder.path()) == 1);
  CHECK_THROWS_WITH_AS(output.commit(), Contains("was written already"), Error);
}

TEST_CASE("without commit the old file stays and nothing is left behind") {
  const TemporaryFolder folder;
  const std::filesystem::path target = folder.write("old", "base.json");
  {
    OutputFile output(target);
    output.write(std::string(1'000'000, 'x'));
    CHECK(count_files(folder.path()) == (has_nameless_files(folder.path()) ? 1 : 2));
  }
  CHECK(read_bytes(target) == "old");
  CHECK(count_files(folder.path()) == 1);
}

TEST_CASE("what was flushed is still not there before commit") {
  const TemporaryFolder folder;
  const std::filesystem::path target = folder.write("old", "base.json");
  OutputFile output(target);
  output.write("new");
  output.flush();
  CHECK(read_bytes(target) == "old");
  output.write("er");
  output.commit();
  CHECK(read_bytes(target) == "newer");
  CHECK_THROWS_WITH_AS(output.flush(), Contains("was written already"), Error);
}

TEST_CASE("one file under two names is one file") {
  const TemporaryFolder folder;
  const std::filesystem::path log = folder.write("log", "flight.csv");
  const std::filesystem::path other = folder.write("log", "other.csv");
  std::filesystem::create_symlink("flight.csv", folder.path() / "link.csv");
  std::filesystem::create_hard_link(log, folder.path() / "hard.csv");
  std::filesystem::create_symlink("nowhere.csv", folder.path() / "dangling.csv");
  for (const char* name : {"flight.csv", "./flight.csv", "link.csv", "hard.csv"}) {
    CAPTURE(name);
    CHECK(sepcal::is_same_file(folder.path() / name, log));
    CHECK_THROWS_WITH_AS(sepcal::check_not_input(folder.path() / name, log),
                         Contains("name another file"), Error);
  }
  CHECK(sepcal::is_same_file(folder.path() / "dangling.csv", folder.path() / "nowhere.csv"));
  CHECK_FALSE(sepcal::is_same_file(folder.path() / "one.csv", folder.path() / "two.csv"));
  CHECK_FALSE(sepcal::is_same_file(other, log));
  CHECK_NOTHROW(sepcal::check_not_input(other, log));
  CHECK_NOTHROW(sepcal::check_not_input("/dev/null", "/dev/null"));  // nothing to lose
}

TEST_CASE("large output arrives whole") {
  const TemporaryFolder folder;
  std::string text;
  for (int i = 0; i < 100'000; ++i) text += std::to_string(i) + '\n';
  OutputFile output(folder.path() / "all.csv");
  for (std::size_t at = 0; at < text.size(); at += 1000) {
    output.stream() << text.substr(at, 999);
    if (at + 999 < text.size()) output.stream().put(text[at + 999]);
  }
  output.commit();
  CHECK(read_bytes(folder.path() / "all.csv") == text);
}

TEST_CASE("two outputs at a time don't meet") {
  const TemporaryFolder folder;
  OutputFile first(folder.path() / "a");
  OutputFile second(folder.path() / "b");
  first.write("first");
  second.write("second");
  second.commit();
  first.commit();
  CHECK(read_bytes(folder.path() / "a") == "first");
  CHECK(read_bytes(folder.path() / "b") == "second");
}

TEST_CASE("targets that can't be") {
  const TemporaryFolder folder;
  const auto nowhere = folder.path() / "missing" / "base.json";
  CHECK_THROWS_WITH_AS(OutputFile{nowhere},
                       (nowhere.string() + ": folder '" + nowhere.parent_path().string() +
                        "' isn't there; make it first")
                           .c_str(),
                       Error);
  CHECK_THROWS_WITH_AS(OutputFile{folder.path()}, Contains("is a folder"), Error);
  CHECK_THROWS_WITH_AS(OutputFile{folder.path() / ""}, Contains("is a folder"), Error);
  CHECK_THROWS_WITH_AS(OutputFile{""}, Contains("names no file"), Error);
  const auto file = folder.write("x", "file");
  CHECK_THROWS_WITH_AS(OutputFile{file + "/base.json"}, Contains("isn't there"), Error);
  CHECK(count_files(folder.path()) == 1);
}

TEST_CASE("a name of another form than text is refused") {
  const TemporaryFolder folder;
  for (const char* name : {"log.xlsx", "log.Parquet", "log.csv.gz"}) {
    CHECK_THROWS_WITH_AS(OutputFile(folder.path() / name), Contains("what is written is text"),
                         Error);
  }
  OutputFile(folder.path() / "log.csv");
}

TEST_CASE("permissions are respected") {
  const TemporaryFolder folder;
  const std::filesystem::path target = folder.write("old", "base.json");
  ::chmod(target.c_str(), 0444);
  ::chmod(folder.path().c_str(), 0777);
  {
    const Unprivileged user;
    CHECK_THROWS_WITH_AS(OutputFile{target}, Contains("can't be written: Permission denied"),
                         Error);
  }
  ::chmod(folder.path().c_str(), 0555);
  {
    const Unprivileged user;
    CHECK_THROWS_WITH_AS(OutputFile{folder.path() / "new.json"},
                         Contains("can't be written: Permission denied"), Error);
  }
  ::chmod(folder.path().c_str(), 0755);
  CHECK(read_bytes(target) == "old");
  CHECK(count_files(folder.path()) == 1);
}

TEST_CASE("a full disc leaves the old file as it was") {
  const TemporaryFolder folder;
  const std::filesystem::path target = folder.write("old", "base.json");
  const std::string text(1'000'000, 'x');
  const SmallDisc disc(100'000);
  SUBCASE("writing") {
    OutputFile output(target);
    CHECK_THROWS_WITH_AS(output.write(text), Contains("writing failed: File too large"), Error);
  }
  SUBCASE("streaming") {
    OutputFile output(target);
    output.stream() << text << "more";
    CHECK_FALSE(output.stream().good());
    CHECK_THROWS_WITH_AS(output.commit(), Contains("writing failed: File too large"), Error);
  }
  SUBCASE("the last bytes, at commit") {
    OutputFile output(target);
    output.write(text.substr(0, 70'000));
    output.write(text.substr(0, 40'000));
    CHECK_THROWS_WITH_AS(output.commit(), Contains("writing failed: File too large"), Error);
  }
  CHECK(read_bytes(target) == "old");
  CHECK(count_files(folder.path()) == 1);
}

TEST_CASE("a device is written directly and stays a device") {
  OutputFile full("/dev/full");
  full.write("x");
  CHECK_THROWS_WITH_AS(full.commit(), "/dev/full: writing failed: No space left on device", Error);
  OutputFile null("/dev/null");
  null.write("x");
  null.commit();
  CHECK(std::filesystem::is_character_file("/dev/null"));
}

TEST_CASE("an old file keeps its permissions, a new one has the umask's") {
  const TemporaryFolder folder;
  const std::filesystem::path old = folder.write("old", "old.json");
  ::chmod(old.c_str(), 0640);
  const mode_t before = ::umask(0027);
  for (const auto& target : {old, folder.path() / "new.json"}) {
    OutputFile output(target);
    output.write("x");
    output.commit();
  }
  CHECK(mode_of(folder.path() / "new.json") == 0640);
  ::chmod(old.c_str(), 0604);
  OutputFile output(old);
  output.write("y");
  output.commit();
  ::umask(before);
  CHECK(mode_of(old) == 0604);
  CHECK(read_bytes(old) == "y");
}

TEST_CASE("symbolic links are followed, also to a file that isn't there yet") {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "results");
  folder.write("old", "results/one.json");
  std::filesystem::create_symlink("results/one.json", folder.path() / "one");
  std::filesystem::create_symlink("results/two.json", folder.path() / "two");
  for (const char* link : {"one", "two"}) {
    OutputFile output(folder.path() / link);
    output.write(link);
    output.commit();
    CHECK(std::filesystem::is_symlink(folder.path() / link));
    CHECK(read_bytes(folder.path() / "results" / (std::string(link) + ".json")) == link);
  }
}

TEST_CASE("a loop of symbolic links is refused and stays") {
  const TemporaryFolder folder;
  std::filesystem::create_symlink("round", folder.path() / "there");
  std::filesystem::create_symlink("there", folder.path() / "round");
  std::filesystem::create_symlink("self", folder.path() / "self");
  for (const char* name : {"there", "self"}) {
    CAPTURE(name);
    CHECK_THROWS_WITH_AS(OutputFile{folder.path() / name},
                         Contains("is a loop of symbolic links; name a file"), Error);
    CHECK(std::filesystem::is_symlink(folder.path() / name));
  }
  CHECK_FALSE(sepcal::is_same_file(folder.path() / "there", folder.path() / "self"));
  CHECK(count_files(folder.path()) == 3);
}

TEST_CASE("a name that is too long is refused before the work") {
  const TemporaryFolder folder;
  CHECK_THROWS_WITH_AS(OutputFile{folder.path() / std::string(300, 'x')},
                       Contains("can't be written: File name too long"), Error);
}

TEST_CASE("of several texts all files are written or none") {
  const TemporaryFolder folder;
  const auto old = folder.write("old", "one");
  const auto one = (folder.path() / "one").string();
  const auto two = (folder.path() / "two").string();
  CHECK_THROWS_WITH_AS(sepcal::write_whole({{one, "new"}, {two + "/three", "new"}}),
                       Contains("isn't there"), Error);
  CHECK(read_bytes(old) == "old");
  CHECK(count_files(folder.path()) == 1);
  sepcal::write_whole({{one, "1"}, {two, "2"}});
  CHECK(read_bytes(one) == "1");
  CHECK(read_bytes(two) == "2");
}

TEST_CASE("a name without a folder goes to the current one") {
  const TemporaryFolder folder;
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  OutputFile output("base.json");
  output.write("x");
  output.commit();
  std::filesystem::current_path(before);
  CHECK(read_bytes(folder.path() / "base.json") == "x");
}

}  // namespace output_file_test
