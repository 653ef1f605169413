// SPDX-License-Identifier: BSD-3-Clause
// The board below a flight program: vectors, start, files, a count of instructions and a painted
// stack. The emulator lets an instruction take 64 ns of the board's time (-icount shift=6), and
// SysTick counts 25 MHz of it.
#include <cstdint>

#include "link.hpp"
#include "semihosting.hpp"

extern "C" {
extern std::uint32_t stack_top;
extern std::uint32_t data_begin;
extern std::uint32_t data_end;
extern std::uint32_t data_image;
extern std::uint32_t bss_begin;
extern std::uint32_t bss_end;
using Initialiser = void (*)();
extern Initialiser init_begin;
extern Initialiser init_end;

[[noreturn]] void reset();
void fault();
void tick();
}

namespace {

using semihosting::Call;

constexpr std::uint32_t paint = 0xdeadbeef;
constexpr std::uint32_t nanoseconds_a_tick = 40;
constexpr std::uint32_t nanoseconds_an_instruction = 64;
constexpr std::uint32_t reload = 0xffffff;  // SysTick counts down from it

volatile std::uint32_t& word(std::uint32_t address) {
  return *reinterpret_cast<volatile std::uint32_t*>(address);
}
volatile std::uint32_t& systick_control() { return word(0xe000e010); }
volatile std::uint32_t& systick_reload() { return word(0xe000e014); }
volatile std::uint32_t& systick_value() { return word(0xe000e018); }
volatile std::uint32_t& coprocessor_access() { return word(0xe000ed88); }

volatile std::uint32_t rounds = 0;  // of SysTick

void say(const char* text) { semihosting::call(Call::write_text, text); }

[[noreturn]] void end(bool well) {
  constexpr std::uint32_t stopped = 0x20026;  // ADP_Stopped_ApplicationExit
  constexpr std::uint32_t failed = 0x20024;   // ADP_Stopped_InternalError
  semihosting::call(Call::exit, reinterpret_cast<const void*>(well ? stopped : failed));
  for (;;) {
  }
}

int open(const char* name, std::uint32_t length, std::uint32_t mode) {
  const std::uint32_t arguments[3] = {reinterpret_cast<std::uint32_t>(name), mode, length};
  return semihosting::call(Call::open, arguments);
}

constexpr int capacity = 512;  // numbers
double arrived[capacity];
int first = 0;
int behind = 0;
double leaving[capacity];
int waiting = 0;
int in_file = -1;
int out_file = -1;

void flush() {
  const std::uint32_t arguments[3] = {static_cast<std::uint32_t>(out_file),
                                      reinterpret_cast<std::uint32_t>(leaving),
                                      static_cast<std::uint32_t>(waiting) * 8U};
  if (semihosting::call(Call::write, arguments) != 0) trapped("out.bin can't be written");
  waiting = 0;
}

}  // namespace

void target::read(double* numbers, int count) {
  for (int k = 0; k < count; ++k) {
    if (first == behind) {
      const std::uint32_t arguments[3] = {static_cast<std::uint32_t>(in_file),
                                          reinterpret_cast<std::uint32_t>(arrived), sizeof arrived};
      const auto missing = static_cast<std::uint32_t>(semihosting::call(Call::read, arguments));
      first = 0;
      behind = missing > sizeof arrived ? 0 : static_cast<int>((sizeof arrived - missing) / 8U);
      if (behind == 0) trapped("in.bin is too short");
    }
    numbers[k] = arrived[first++];
  }
}

void target::write(const double* numbers, int count) {
  for (int k = 0; k < count; ++k) {
    leaving[waiting++] = numbers[k];
    if (waiting == capacity) flush();
  }
}

std::uint64_t target::instructions() {
  std::uint32_t before = 0;
  std::uint32_t value = 0;
  do {  // a round may end between two readings
    before = rounds;
    value = systick_value();
  } while (before != rounds);
  const std::uint64_t ticks = std::uint64_t{before} * (reload + 1ULL) + (reload - value);
  return ticks * nanoseconds_a_tick / nanoseconds_an_instruction;
}

std::uint32_t target::deepest_stack() {
  const std::uint32_t* lowest = &bss_end;
  while (*lowest == paint) ++lowest;
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(&stack_top) -
                                    reinterpret_cast<std::uintptr_t>(lowest));
}

extern "C" {

void trapped(const char* what) {
  say("trapped: ");
  say(what);
  say("\n");
  end(false);
}

void fault() { trapped("a fault of the processor"); }

void tick() { rounds = rounds + 1; }

/// Whoever calls a pure virtual function, or registers a destructor, has no place on board.
void __cxa_pure_virtual() { trapped("a pure virtual function was called"); }

void reset() {
  coprocessor_access() =
      coprocessor_access() | 0xf00000;  // the floating-point unit, before it is used
  asm volatile("dsb\nisb");
  std::uint32_t* from = &data_image;
  for (std::uint32_t* to = &data_begin; to < &data_end; ++to) *to = *from++;
  for (std::uint32_t* to = &bss_begin; to < &bss_end; ++to) *to = 0;
  std::uint32_t* here = nullptr;
  asm volatile("mov %0, sp" : "=r"(here));
  for (std::uint32_t* to = &bss_end; to < here - 64; ++to) *to = paint;
  for (Initialiser* one = &init_begin; one < &init_end; ++one) (*one)();
  systick_reload() = reload;
  systick_value() = 0;
  systick_control() = 7;             // the processor's clock, an interrupt a round, on
  in_file = open("in.bin", 6, 1);    // "rb"
  out_file = open("out.bin", 7, 5);  // "wb"
  if (in_file < 0 || out_file < 0) trapped("in.bin or out.bin can't be opened");
  fly();
  target::write(static_cast<double>(target::deepest_stack()));
  flush();
  end(true);
}

[[gnu::section(".vectors"), gnu::used]] const void* const vectors[16] = {
    &stack_top,
    reinterpret_cast<const void*>(&reset),
    reinterpret_cast<const void*>(&fault),  // NMI
    reinterpret_cast<const void*>(&fault),
    reinterpret_cast<const void*>(&fault),
    reinterpret_cast<const void*>(&fault),
    reinterpret_cast<const void*>(&fault),
    nullptr,
    nullptr,
    nullptr,
    nullptr,
    reinterpret_cast<const void*>(&fault),  // SVC
    nullptr,
    nullptr,
    reinterpret_cast<const void*>(&fault),
    reinterpret_cast<const void*>(&tick)};
}
