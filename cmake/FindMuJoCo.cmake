# SPDX-License-Identifier: GPL-3.0-or-later
# MuJoCo, whose compiler reads MJCF files. The CMake package of Debian 12 names an include folder that does not exist. Defines the target
# MuJoCo::MuJoCo and MuJoCo_VERSION.
include(FindPackageHandleStandardArgs)

find_path(MuJoCo_INCLUDE_DIR mujoco/mujoco.h)
find_library(MuJoCo_LIBRARY mujoco)
if(MuJoCo_INCLUDE_DIR)
    file(STRINGS "${MuJoCo_INCLUDE_DIR}/mujoco/mujoco.h" _mujoco_line REGEX "define mjVERSION_HEADER")
    if(_mujoco_line MATCHES "([0-9]+)([0-9])([0-9])$")
        set(MuJoCo_VERSION "${CMAKE_MATCH_1}.${CMAKE_MATCH_2}.${CMAKE_MATCH_3}")
    endif()
endif()
find_package_handle_standard_args(MuJoCo REQUIRED_VARS MuJoCo_LIBRARY MuJoCo_INCLUDE_DIR VERSION_VAR MuJoCo_VERSION)

if(MuJoCo_FOUND AND NOT TARGET MuJoCo::MuJoCo)
    add_library(MuJoCo::MuJoCo UNKNOWN IMPORTED)
    set_target_properties(MuJoCo::MuJoCo PROPERTIES
        IMPORTED_LOCATION "${MuJoCo_LIBRARY}" INTERFACE_INCLUDE_DIRECTORIES "${MuJoCo_INCLUDE_DIR}")
endif()
mark_as_advanced(MuJoCo_INCLUDE_DIR MuJoCo_LIBRARY)
