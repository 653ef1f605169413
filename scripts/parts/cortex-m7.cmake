# SPDX-License-Identifier: BSD-3-Clause
# Toolchain: Debian's gcc-arm-none-eabi for a Cortex-M7 with its double-precision unit.
set(CMAKE_SYSTEM_NAME Generic)
set(CMAKE_SYSTEM_PROCESSOR arm)
set(CMAKE_C_COMPILER arm-none-eabi-gcc)
set(CMAKE_CXX_COMPILER arm-none-eabi-g++)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY) # there is no system to link a program for
set(processor "-mcpu=cortex-m7 -mfpu=fpv5-d16 -mfloat-abi=hard -mthumb")
set(CMAKE_C_FLAGS_INIT "${processor} -ffunction-sections -fdata-sections")
set(CMAKE_CXX_FLAGS_INIT "${processor} -ffunction-sections -fdata-sections -Wno-psabi")
