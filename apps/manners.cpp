// SPDX-License-Identifier: BSD-3-Clause
#include "manners.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "base/unnamed_file.hpp"
#include "sepcal/error.hpp"

namespace sepcal::app {
namespace {

/// read() or write() that a signal does not end.
template <class Call>
ssize_t repeated(const Call& call) {
  ssize_t done = 0;
  do {
    done = call();
  } while (done < 0 && errno == EINTR);
  return done;
}

bool copy(int from, int to) {
  std::array<char, 1U << 16U> part{};
  while (true) {
    const ssize_t got = repeated([&] { return ::read(from, part.data(), part.size()); });
    if (got <= 0) return got == 0;
    for (ssize_t sent = 0; sent < got;) {
      const auto rest = static_cast<std::size_t>(got - sent);
      const ssize_t put = repeated([&] { return ::write(to, part.data() + sent, rest); });
      if (put < 0) return false;
      sent += put;
    }
  }
}

}  // namespace

bool takes_project(const CLI::App& verb) {
  const std::string& name = verb.get_name();
  return name == "check" || name == "fit" || name == "two-step";
}

Manners& manners() {
  static Manners typed;
  return typed;
}

void add_manners(CLI::App& verb) {
  Manners& typed = manners();
  verb.option_defaults()->group(result_group);
  verb.add_flag("-q,--quiet", typed.quiet, "prints no page, no notes and no progress");
  verb.add_flag("-v,--verbose", typed.verbose,
                "prints everything, also what was read and how long it took");
  verb.add_flag("--exit-zero", typed.exit_zero,
                "exits with 0 if there is a result, whatever its status or verdict");
  if (takes_project(verb)) {
    verb.add_option("--project", typed.project,
                    "the project file that describes the instrument (default: sepcal.toml in the "
                    "flight's folder or above)")
        ->type_name("FILE.toml");
  }
  verb.get_help_ptr()->group(result_group);
  for (const char* const option : {"--output", "--json", "--explain"}) {
    if (CLI::Option* const known = verb.get_option_no_throw(option)) known->group(result_group);
  }
}

void spool_standard_input() {
  struct stat state{};
  if (::fstat(STDIN_FILENO, &state) != 0 || S_ISREG(state.st_mode)) return;
  const std::string folder = base::temporary_folder();
  const int spool = base::open_scratch_file(folder);
  if (spool < 0 || !copy(STDIN_FILENO, spool) || ::dup2(spool, STDIN_FILENO) < 0) {
    throw Error(
        fmt::format("standard input can't be kept in {}: {}; set TMPDIR to a folder with "
                    "room, or name a file",
                    folder, std::strerror(errno)));
  }
  ::close(spool);
}

}  // namespace sepcal::app
