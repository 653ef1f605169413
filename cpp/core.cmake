# SPDX-License-Identifier: BSD-3-Clause
# sepcal::core: headers that need Eigen alone and nothing of an operating system; how they and the
# package's files for CMake and pkg-config are installed. The core's room in rooms.toml lists them:
# without the engine (SEPCAL_BUILD_ENGINE=OFF) no other is installed.
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS rooms.toml)
file(READ rooms.toml rooms)
string(REGEX MATCH "\n\\[core\\][^\n]*\n[^\n]*\npublic = \\[([^]]*)\\]" core_room "${rooms}")
string(REGEX MATCHALL "[a-z_/]+" core_headers "${CMAKE_MATCH_1}")
list(TRANSFORM core_headers PREPEND include/sepcal/)
list(TRANSFORM core_headers APPEND .hpp)
list(APPEND core_headers include/sepcal/core_c.h)

add_library(sepcal_core INTERFACE)
add_library(sepcal::core ALIAS sepcal_core)
target_sources(sepcal_core INTERFACE FILE_SET HEADERS BASE_DIRS include FILES ${core_headers})
target_include_directories(
  sepcal_core INTERFACE $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
                        $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_link_libraries(sepcal_core INTERFACE Eigen3::Eigen)
target_compile_features(sepcal_core INTERFACE cxx_std_20)
# A program for another instruction set must free what the library allocates (sepcal/detail/eigen.hpp).
set(core_definitions EIGEN_MAX_ALIGN_BYTES=64 EIGEN_MAX_STATIC_ALIGN_BYTES=64)
target_compile_definitions(sepcal_core INTERFACE ${core_definitions})
set_target_properties(sepcal_core PROPERTIES EXPORT_NAME core)

set(sepcal_package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/sepcal)
install(
  TARGETS sepcal_core
  EXPORT sepcal_core_targets
  FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(
  EXPORT sepcal_core_targets
  FILE sepcal-core-targets.cmake
  NAMESPACE sepcal::
  DESTINATION ${sepcal_package_folder})

set(sepcal_components core)
set(architecture ARCH_INDEPENDENT) # headers installed on any machine are any processor's
if(SEPCAL_BUILD_ENGINE)
  list(APPEND sepcal_components engine states)
  set(architecture "")
endif()
if(SEPCAL_BUILD_FLIGHT)
  list(APPEND sepcal_components flight simulation aircraft)
endif()
include(CMakePackageConfigHelpers)
configure_package_config_file(
  sepcal-config.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/sepcal-config.cmake
  INSTALL_DESTINATION ${sepcal_package_folder})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/sepcal-config-version.cmake
                                 COMPATIBILITY SameMinorVersion ${architecture})
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/sepcal-config.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/sepcal-config-version.cmake
        DESTINATION ${sepcal_package_folder})

# sepcal_install_pc(NAME): NAME.pc, which finds its prefix from where it lies.
cmake_path(RELATIVE_PATH CMAKE_INSTALL_PREFIX BASE_DIRECTORY ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig
           OUTPUT_VARIABLE sepcal_pc_to_prefix)
set(sepcal_pc_includedir "\${prefix}")
cmake_path(APPEND sepcal_pc_includedir ${CMAKE_INSTALL_INCLUDEDIR})
set(sepcal_pc_libdir "\${prefix}")
cmake_path(APPEND sepcal_pc_libdir ${CMAKE_INSTALL_LIBDIR})
list(TRANSFORM core_definitions PREPEND -D OUTPUT_VARIABLE sepcal_pc_definitions)
list(JOIN sepcal_pc_definitions " " sepcal_pc_definitions)
function(sepcal_install_pc name)
  configure_file(${name}.pc.in ${CMAKE_CURRENT_BINARY_DIR}/${name}.pc @ONLY)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endfunction()
sepcal_install_pc(sepcal-core)
