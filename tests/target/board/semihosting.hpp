// SPDX-License-Identifier: BSD-3-Clause
// Files and an end by the emulator's semihosting ("Semihosting for AArch32 and AArch64", Arm): a
// breakpoint with a number in r0 and a block of arguments in r1. No stdio, which asks for memory.
#pragma once

#include <cstdint>

namespace semihosting {

enum class Call : std::uint32_t {
  open = 0x01,
  write_text = 0x04,
  write = 0x05,
  read = 0x06,
  exit = 0x18
};

inline std::int32_t call(Call number, const void* arguments) {
  register std::uint32_t r0 asm("r0") = static_cast<std::uint32_t>(number);
  register const void* r1 asm("r1") = arguments;
  asm volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
  return static_cast<std::int32_t>(r0);
}

}  // namespace semihosting
