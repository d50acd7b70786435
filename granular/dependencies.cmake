# SPDX-License-Identifier: GPL-3.0-or-later
# The libraries of granular: OpenMP, Thrust and CLI11.

# Uses the package if it is installed, else the bare headers, for machines without the packages.
function(granular_headers target package header)
    find_package(${package} ${ARGN} CONFIG QUIET)
    if(NOT TARGET ${target})
        find_path(granular_${package}_headers ${header})
        if(NOT granular_${package}_headers)
            message(FATAL_ERROR "Neither the package ${package} nor the header ${header} was found. Install it, or set CMAKE_PREFIX_PATH to its location.")
        endif()
        add_library(${target} INTERFACE IMPORTED GLOBAL)
        target_include_directories(${target} INTERFACE "${granular_${package}_headers}")
    endif()
endfunction()

# Also creates granular_thrust_target. A macro, so that the versions are known where it is called.
macro(granular_find_dependencies)
    if(NOT TARGET OpenMP::OpenMP_CXX)
        find_package(OpenMP REQUIRED COMPONENTS CXX)
    endif()
    if(NOT COMMAND thrust_create_target)
        # Thrust 1.17 or later: from Debian, or else from the CUDA toolkit
        find_package(Thrust CONFIG REQUIRED HINTS ENV CUDA_PATH ENV CUDA_HOME PATHS /usr/local/cuda
            PATH_SUFFIXES lib64/cmake/thrust lib/cmake/thrust targets/x86_64-linux/lib/cmake/thrust)
    endif()
    set(granular_thrust OMP CACHE STRING "Thrust on the CPU: OMP or CPP")
    if(NOT TARGET granular_thrust_target)
        thrust_create_target(granular_thrust_target HOST CPP DEVICE ${granular_thrust})
    endif()
    granular_headers(CLI11::CLI11 CLI11 CLI/CLI.hpp)
endmacro()
