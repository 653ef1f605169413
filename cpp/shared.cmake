# SPDX-License-Identifier: BSD-3-Clause
# libsepcal.so: engine, states, flight, simulation, aircraft, and the command lines where programs or
# Python modules are built. Its ABI holds within a minor version: libsepcal.so.0.1 serves what was
# compiled with any 0.1 of the headers (docs/cpp.md).
set(parts sepcal sepcal_states)
if(SEPCAL_BUILD_FLIGHT)
  list(APPEND parts sepcal_flight sepcal_simulation sepcal_aircraft)
endif()
if(TARGET sepcal_command_line)
  list(APPEND parts sepcal_command_line sepcal_aircraft_command_line)
endif()
list(TRANSFORM parts REPLACE "(.+)" "$<TARGET_OBJECTS:\\1>" OUTPUT_VARIABLE objects)
get_target_property(kits sepcal SEPCAL_KIT_OBJECTS)
if(kits)
  set_source_files_properties(${kits} PROPERTIES EXTERNAL_OBJECT ON GENERATED ON)
  list(APPEND objects ${kits})
endif()

add_library(sepcal_shared SHARED ${objects})
add_library(sepcal::shared ALIAS sepcal_shared)
add_dependencies(sepcal_shared ${parts})
target_link_libraries(
  sepcal_shared
  PUBLIC sepcal_core Ceres::ceres
  PRIVATE fmt::fmt ${SEPCAL_SOLVER_LOG} NLopt::nlopt Threads::Threads)
if(SEPCAL_BUILD_FLIGHT)
  target_link_libraries(sepcal_shared PRIVATE ZLIB::ZLIB ${SEPCAL_ZSTD})
endif()
# The programs and modules here include what is the library's own.
list(GET parts -1 last)
target_include_directories(
  sepcal_shared INTERFACE "$<BUILD_INTERFACE:$<TARGET_PROPERTY:${last},INTERFACE_INCLUDE_DIRECTORIES>>")
target_compile_definitions(
  sepcal_shared INTERFACE "$<BUILD_INTERFACE:$<TARGET_PROPERTY:${last},INTERFACE_COMPILE_DEFINITIONS>>")
target_compile_options(
  sepcal_shared INTERFACE "$<BUILD_INTERFACE:$<TARGET_PROPERTY:${last},INTERFACE_COMPILE_OPTIONS>>")
set(abi ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set_target_properties(sepcal_shared PROPERTIES LINKER_LANGUAGE CXX OUTPUT_NAME sepcal EXPORT_NAME shared VERSION ${abi}
                                               SOVERSION ${abi})
install(
  TARGETS sepcal_shared
  EXPORT sepcal_targets
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
