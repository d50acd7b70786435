# SPDX-License-Identifier: GPL-3.0-or-later
# Compiles through ccache if it is installed. A second clone on the same machine then reuses the objects of the first.
#
# CCACHE_SLOPPINESS is required with precompiled headers, which define macros and contain time stamps. CCACHE_BASEDIR and
# CCACHE_NOHASHDIR make the cache keys independent of the folder of the clone.
option(HILDA_CCACHE "Compile through ccache if it is installed" ON)
find_program(HILDA_CCACHE_PROGRAM ccache)
mark_as_advanced(HILDA_CCACHE_PROGRAM)
if(HILDA_CCACHE AND HILDA_CCACHE_PROGRAM AND NOT DEFINED CMAKE_CXX_COMPILER_LAUNCHER)
    set(CMAKE_CXX_COMPILER_LAUNCHER
        "${CMAKE_COMMAND}" -E env CCACHE_SLOPPINESS=pch_defines,time_macros "CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}"
        CCACHE_NOHASHDIR=true "${HILDA_CCACHE_PROGRAM}")
    set(CMAKE_CUDA_COMPILER_LAUNCHER "${CMAKE_CXX_COMPILER_LAUNCHER}")
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
        # ccache reads the preprocessed text, in which GCC then names the precompiled header.
        add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess>)
    endif()
endif()
