# SPDX-License-Identifier: GPL-3.0-or-later
# The header <hilda/version.hpp>. Configuration sets all values except the git state; each build sets the git
# state (git_state.cmake).

string(TOUPPER "${CMAKE_BUILD_TYPE}" hilda_build_type)
list(JOIN hilda_flags " " hilda_version_flags)
string(STRIP "${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${hilda_build_type}}" hilda_version_base)
string(PREPEND hilda_version_flags "${hilda_version_base} ")
if(CMAKE_BUILD_TYPE STREQUAL "Release" AND NOT HILDA_NATIVE)
    list(JOIN hilda_optimised_rooms ", " hilda_version_rooms)
    string(APPEND hilda_version_flags " (-O3 in ${hilda_version_rooms})")
endif()

set(hilda_generated "${PROJECT_BINARY_DIR}/generated")
set(hilda_git "@hilda_git@") # replaced at each build
configure_file(cmake/version.hpp.in "${hilda_generated}/version.hpp.in" @ONLY)

find_package(Git QUIET)
add_custom_target(hilda_version ALL
    COMMAND ${CMAKE_COMMAND} -D "git=${GIT_EXECUTABLE}" -D "source=${PROJECT_SOURCE_DIR}"
        -D "input=${hilda_generated}/version.hpp.in" -D "output=${hilda_generated}/hilda/version.hpp"
        -P "${PROJECT_SOURCE_DIR}/cmake/git_state.cmake"
    BYPRODUCTS "${hilda_generated}/hilda/version.hpp"
    COMMENT "Git state"
    VERBATIM)

# Makes <hilda/version.hpp> available to a target.
function(hilda_use_version target)
    target_include_directories(${target} PRIVATE "${hilda_generated}")
    add_dependencies(${target} hilda_version)
endfunction()
