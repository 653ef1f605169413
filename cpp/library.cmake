# SPDX-License-Identifier: BSD-3-Clause
# What every compiled library of sepcal's has in common, and how each is installed.

# sepcal_library(TARGET NAME): sepcal::NAME, here and for those who find an installed sepcal.
function(sepcal_library target name)
  set_target_properties(
    ${target} PROPERTIES POSITION_INDEPENDENT_CODE ON CXX_EXTENSIONS OFF UNITY_BUILD ${SEPCAL_UNITY}
                         UNITY_BUILD_BATCH_SIZE 24 EXPORT_NAME ${name})
  target_include_directories(${target} PRIVATE src)
  add_library(sepcal::${name} ALIAS ${target})
  install(
    TARGETS ${target}
    EXPORT sepcal_targets
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
endfunction()

install(
  EXPORT sepcal_targets
  FILE sepcal-targets.cmake
  NAMESPACE sepcal::
  DESTINATION ${sepcal_package_folder})

# The engine is an archive: who links it links what it was compiled with. Ceres has no .pc file.
set(sepcal_nlopt_pc nlopt)
if(TARGET NLopt::nlopt_cxx)
  set(sepcal_nlopt_pc nlopt_cxx)
endif()
sepcal_install_pc(sepcal)
