// SPDX-License-Identifier: BSD-3-Clause
#include "starting.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <string_view>

namespace sepcal::app {
namespace {

constexpr int no_memory = 2;  // bad input: less of it would do

std::string_view program = "sepcal";
std::atomic<bool> memory_ran_out = false;
std::terminate_handler usual_end = &std::abort;

/// Where no exception can be caught.
[[noreturn]] void end_without_memory() {
  for (const std::string_view part : {program, std::string_view(": memory ran out\n")}) {
    [[maybe_unused]] const auto said = ::write(STDERR_FILENO, part.data(), part.size());
  }
  ::_exit(no_memory);
}

/// As without a handler; but who has to end the program then knows why.
void refuse_memory() {
  memory_ran_out = true;
  throw std::bad_alloc();
}

bool is_out_of_memory(const std::exception_ptr& failure) {
  try {
    if (failure) std::rethrow_exception(failure);
  } catch (const std::bad_alloc&) {
    return true;
  } catch (...) {
    return false;  // a fault of the program
  }
  return false;
}

/// Memory that runs out in a destructor, as of JSON, can't be caught either.
[[noreturn]] void end_uncaught() {
  if (memory_ran_out || is_out_of_memory(std::current_exception())) end_without_memory();
  usual_end();
  std::abort();
}

/// The libraries set themselves up before main, outside of any try.
void prepare(int argc, char** argv, char** /*environment*/) {
  if (argc > 0) program = std::string_view(argv[0]);
  program.remove_prefix(program.rfind('/') + 1);
  std::set_new_handler(&end_without_memory);
  usual_end = std::set_terminate(&end_uncaught);
}

#ifdef __linux__
/// What stands in this section runs first in a program, before any library's own start.
[[gnu::section(".preinit_array"), gnu::used]] void (*const first)(int, char**, char**) = &prepare;
#endif

/// A file that is opened while a stream is closed takes its number, and what is said then goes into
/// the file. Nothing can be printed on what stands in for standard output: that is told as before.
void open_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) != -1) continue;
    const int flags = stream == STDERR_FILENO ? O_WRONLY : O_RDONLY;
    [[maybe_unused]] const int lowest = ::open("/dev/null", flags);  // the stream's own number
  }
}

}  // namespace

int start(const char* program_name, const std::function<int()>& perform) try {
  std::set_new_handler(&refuse_memory);
  open_streams();
  return perform();
} catch (...) {
  std::fputs(program_name, stderr);
  std::fputs(": memory ran out\n", stderr);
  return no_memory;
}

}  // namespace sepcal::app
