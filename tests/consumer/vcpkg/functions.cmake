# SPDX-License-Identifier: BSD-3-Clause
# What the portfile calls of vcpkg, written down from its documentation for a machine without it: as
# much as happens to sepcal's files.

# vcpkg_check_features(OUT_FEATURE_OPTIONS VARIABLE FEATURES [FEATURE OPTION]...)
function(vcpkg_check_features)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" OUT_FEATURE_OPTIONS FEATURES)
  set(options "")
  while(arg_FEATURES)
    list(POP_FRONT arg_FEATURES feature option)
    set(chosen OFF)
    if(feature IN_LIST FEATURES)
      set(chosen ON)
    endif()
    set(${option} ${chosen} PARENT_SCOPE)
    list(APPEND options -D${option}=${chosen})
  endwhile()
  set(${arg_OUT_FEATURE_OPTIONS} ${options} PARENT_SCOPE)
endfunction()

function(vcpkg_check_linkage)
endfunction()

# Once for each type of build, with the prefix of its packages.
function(vcpkg_cmake_configure)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" SOURCE_PATH OPTIONS)
  set(types Release Debug)
  if(VCPKG_BUILD_TYPE STREQUAL "release")
    set(types Release)
  endif()
  foreach(type IN LISTS types)
    set(prefix "${CURRENT_PACKAGES_DIR}")
    if(type STREQUAL "Debug")
      string(APPEND prefix /debug)
    endif()
    execute_process(
      COMMAND ${CMAKE_COMMAND} -S ${arg_SOURCE_PATH} -B ${CURRENT_BUILDTREES_DIR}/${type} -G Ninja
              -DCMAKE_BUILD_TYPE=${type} -DCMAKE_INSTALL_PREFIX=${prefix} -DCMAKE_INSTALL_LIBDIR=lib
              ${arg_OPTIONS} ${CONFIGURE_OPTIONS}
      COMMAND_ERROR_IS_FATAL ANY)
  endforeach()
endfunction()

function(vcpkg_cmake_install)
  file(GLOB builds "${CURRENT_BUILDTREES_DIR}/*")
  foreach(build IN LISTS builds)
    execute_process(COMMAND ${CMAKE_COMMAND} --build ${build} --target install COMMAND_ERROR_IS_FATAL ANY)
  endforeach()
endfunction()

# From CONFIG_PATH to share/PORT, where a file's prefix is two folders up.
function(vcpkg_cmake_config_fixup)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" CONFIG_PATH "")
  set(share "${CURRENT_PACKAGES_DIR}/share/${PORT}")
  file(GLOB files "${CURRENT_PACKAGES_DIR}/${arg_CONFIG_PATH}/*.cmake")
  if(NOT files)
    message(FATAL_ERROR "the portfile says ${arg_CONFIG_PATH}, and no CMake file was installed there")
  endif()
  set(up "get_filename_component(_IMPORT_PREFIX \"\${_IMPORT_PREFIX}\" PATH)\n")
  foreach(file IN LISTS files)
    file(READ "${file}" text)
    string(REPLACE "${up}${up}${up}" "${up}${up}" text "${text}")
    string(REPLACE "\${CMAKE_CURRENT_LIST_DIR}/../../../" "\${CMAKE_CURRENT_LIST_DIR}/../../" text "${text}")
    cmake_path(GET file FILENAME name)
    file(WRITE "${share}/${name}" "${text}")
  endforeach()
  cmake_path(GET arg_CONFIG_PATH PARENT_PATH parent)
  file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/${parent}")
endfunction()

# Every .pc file must find its prefix from where it lies.
function(vcpkg_fixup_pkgconfig)
  file(GLOB files "${CURRENT_PACKAGES_DIR}/lib/pkgconfig/*.pc")
  foreach(file IN LISTS files)
    file(READ "${file}" text)
    string(REGEX REPLACE "(^|\n)prefix=[^\n]*" "\\1prefix=\${pcfiledir}/../.." text "${text}")
    file(WRITE "${file}" "${text}")
  endforeach()
endfunction()

function(vcpkg_install_copyright)
  cmake_parse_arguments(PARSE_ARGV 0 arg "" "" FILE_LIST)
  file(COPY_FILE "${arg_FILE_LIST}" "${CURRENT_PACKAGES_DIR}/share/${PORT}/copyright")
endfunction()
