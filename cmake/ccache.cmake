# SPDX-License-Identifier: GPL-3.0-or-later
# Compiles through ccache if it is installed. A second clone on the same machine then reuses the objects of the first.
#
# CCACHE_SLOPPINESS is required with precompiled headers, which define macros and contain time stamps. CCACHE_BASEDIR and
# CCACHE_NOHASHDIR make the cache keys independent of the folder of the clone.
#
# The first configuration of a build folder decides: a compiler that is called in another way would compile everything again.
option(HILDA_CCACHE "Compile through ccache if it is installed" ON)
if(NOT DEFINED HILDA_CCACHE_PROGRAM)
    find_program(HILDA_CCACHE_PROGRAM ccache)
    if(NOT HILDA_CCACHE_PROGRAM)
        set(HILDA_CCACHE_PROGRAM "" CACHE FILEPATH "ccache; empty if it was not installed at the first configuration" FORCE)
    endif()
endif()
mark_as_advanced(HILDA_CCACHE_PROGRAM)
if(HILDA_CCACHE AND HILDA_CCACHE_PROGRAM AND NOT DEFINED CMAKE_CXX_COMPILER_LAUNCHER)
    set(CMAKE_CXX_COMPILER_LAUNCHER
        "${CMAKE_COMMAND}" -E env CCACHE_SLOPPINESS=pch_defines,time_macros "CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}"
        CCACHE_NOHASHDIR=true CCACHE_PCH_EXTSUM=true "${HILDA_CCACHE_PROGRAM}")
    set(CMAKE_CUDA_COMPILER_LAUNCHER "${CMAKE_CXX_COMPILER_LAUNCHER}")
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
        # ccache reads the preprocessed text, in which GCC then names the precompiled header.
        add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess>)
    endif()
endif()

# Writes the file that stands for the precompiled header of `target` in the keys of ccache. It depends on everything that
# the precompiled header is made of: the compiler, the flags, the list of headers, and the headers of the libraries.
function(hilda_name_precompiled_header target)
    get_target_property(list ${target} PRECOMPILE_HEADERS)
    string(TOUPPER "${CMAKE_BUILD_TYPE}" type)
    set(key "${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION} ${list}")
    string(APPEND key " ${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${type}} ${hilda_flags} ${hilda_warnings}")
    foreach(header Eigen/src/Core/util/Macros.h Eigen/src/Core/Matrix.h catch2/catch.hpp)
        find_file(hilda_header_to_hash "${header}" PATHS /usr/include/eigen3 /usr/include NO_CACHE)
        if(hilda_header_to_hash)
            file(SHA256 "${hilda_header_to_hash}" sum)
            string(APPEND key " ${sum}")
        endif()
        unset(hilda_header_to_hash)
    endforeach()
    string(SHA256 sum "${key}")
    file(WRITE "${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/${target}.dir/cmake_pch.hxx.gch.sum" "${sum}\n")
endfunction()
