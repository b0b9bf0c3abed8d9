# portfile.cmake: the libraries of the tree that this port lies in:
#   vcpkg install palpate --overlay-ports=packaging/vcpkg
# The command is not built: it needs libserialport, which vcpkg does not have.
set(VCPKG_BUILD_TYPE release)
get_filename_component(SOURCE_PATH "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)

vcpkg_find_acquire_program(PKGCONFIG)
vcpkg_cmake_get_vars(cmake_vars_file)
include("${cmake_vars_file}")
set(ENV{PKG_CONFIG_PATH} "${CURRENT_INSTALLED_DIR}/lib/pkgconfig")

vcpkg_execute_required_process(
    COMMAND make -j${VCPKG_CONCURRENCY} install-lib
        "CC=${VCPKG_DETECTED_CMAKE_C_COMPILER}"
        "PKG_CONFIG=${PKGCONFIG} --static"
        "BUILD=${CURRENT_BUILDTREES_DIR}/${TARGET_TRIPLET}-rel"
        "PREFIX=${CURRENT_PACKAGES_DIR}"
    WORKING_DIRECTORY "${SOURCE_PATH}"
    LOGNAME "install-${TARGET_TRIPLET}")

if(VCPKG_LIBRARY_LINKAGE STREQUAL "static")
    file(GLOB unused "${CURRENT_PACKAGES_DIR}/lib/*.so*")
else()
    file(GLOB unused "${CURRENT_PACKAGES_DIR}/lib/*.a")
endif()
if(unused)
    file(REMOVE ${unused})
endif()

vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/palpate)
vcpkg_fixup_pkgconfig()
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
