# SPDX-License-Identifier: BSD-3-Clause
# A port for vcpkg's --overlay-ports: it builds the checkout that it lies in.
cmake_path(NORMAL_PATH CURRENT_PORT_DIR OUTPUT_VARIABLE SOURCE_PATH)
cmake_path(APPEND SOURCE_PATH .. ..)
cmake_path(NORMAL_PATH SOURCE_PATH)

vcpkg_check_features(OUT_FEATURE_OPTIONS FEATURE_OPTIONS
                     FEATURES engine SEPCAL_BUILD_ENGINE flight SEPCAL_BUILD_FLIGHT)
if(SEPCAL_BUILD_ENGINE)
  vcpkg_check_linkage(ONLY_STATIC_LIBRARY)
else()
  set(VCPKG_BUILD_TYPE release) # headers alone
endif()

vcpkg_cmake_configure(SOURCE_PATH "${SOURCE_PATH}" OPTIONS ${FEATURE_OPTIONS} -DSEPCAL_BUILD_APPS=OFF)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/sepcal)
vcpkg_fixup_pkgconfig()

file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/share")
file(INSTALL "${CURRENT_PORT_DIR}/usage" DESTINATION "${CURRENT_PACKAGES_DIR}/share/${PORT}")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
