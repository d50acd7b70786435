# SPDX-License-Identifier: GPL-3.0-or-later
# The reader of URDF files of urdfdom, with its messages (console_bridge). Its own CMake package needs the packages of both, and has
# no version. Defines the target Urdfdom::model.
include(FindPackageHandleStandardArgs)

find_path(Urdfdom_INCLUDE_DIR urdf_parser/urdf_parser.h)
find_path(Urdfdom_console_INCLUDE_DIR console_bridge/console.h)
find_library(Urdfdom_LIBRARY urdfdom_model)
find_library(Urdfdom_console_LIBRARY console_bridge)
find_package_handle_standard_args(Urdfdom
    REQUIRED_VARS Urdfdom_LIBRARY Urdfdom_INCLUDE_DIR Urdfdom_console_LIBRARY Urdfdom_console_INCLUDE_DIR)

if(Urdfdom_FOUND AND NOT TARGET Urdfdom::model)
    add_library(Urdfdom::model UNKNOWN IMPORTED)
    set_target_properties(Urdfdom::model PROPERTIES
        IMPORTED_LOCATION "${Urdfdom_LIBRARY}"
        INTERFACE_INCLUDE_DIRECTORIES "${Urdfdom_INCLUDE_DIR};${Urdfdom_console_INCLUDE_DIR}"
        INTERFACE_LINK_LIBRARIES "${Urdfdom_console_LIBRARY}")
endif()
mark_as_advanced(Urdfdom_INCLUDE_DIR Urdfdom_console_INCLUDE_DIR Urdfdom_LIBRARY Urdfdom_console_LIBRARY)
