# SPDX-License-Identifier: GPL-3.0-or-later
# How a room becomes targets.

# Two precompiled headers: one owned by the lowest room and used by all rooms, one by its tests and used by all tests. A
# source file must include what it uses: the preset `tidy` builds without precompiled headers.
#
# nlohmann/json.hpp, which tests use, is not part of them. Its literal operators instantiate the parser, which costs 0.6 s in
# each file that sees the header, and most files do not use it. Headers with compile definitions (fmt, spdlog) cannot be part of them,
# because the definitions differ between the rooms.
function(hilda_precompile target)
    if(NOT HILDA_PCH)
        return()
    endif()
    set(headers <Eigen/Dense> <algorithm> <cmath> <functional> <map> <memory> <sstream> <string> <vector>)
    if(target STREQUAL "lie_objects")
        target_precompile_headers(${target} PRIVATE ${headers})
        hilda_name_precompiled_header(${target})
    elseif(target STREQUAL "test_lie_objects")
        target_precompile_headers(${target} PRIVATE ${headers} <catch2/catch.hpp>)
        hilda_name_precompiled_header(${target})
    elseif(target MATCHES "^test_")
        target_precompile_headers(${target} REUSE_FROM test_lie_objects)
    else()
        target_precompile_headers(${target} REUSE_FROM lie_objects)
    endif()
endfunction()

# hilda_room(<room> SOURCES <file>... [ROOMS <room>...] [LIBRARIES <target>...])
#
#   <room>_objects  the compiled files; link this to compile against the room
#   hilda_<room>    the room with its objects and all rooms below; link this to make a program
#
# Object libraries, not archives: an archive drops the object files that nobody calls, and the list of schemes
# would be empty. A program that reaches a room by two paths still gets its objects once.
function(hilda_room room)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;ROOMS;LIBRARIES")

    add_library(${room}_objects OBJECT ${arg_SOURCES})
    target_include_directories(${room}_objects PUBLIC "${PROJECT_SOURCE_DIR}")
    target_link_libraries(${room}_objects PUBLIC ${arg_LIBRARIES})
    hilda_precompile(${room}_objects)

    add_library(hilda_${room} INTERFACE)
    target_sources(hilda_${room} INTERFACE $<TARGET_OBJECTS:${room}_objects>)
    target_include_directories(hilda_${room} INTERFACE "${PROJECT_SOURCE_DIR}")
    target_link_libraries(hilda_${room} INTERFACE ${arg_LIBRARIES})

    foreach(below IN LISTS arg_ROOMS)
        target_link_libraries(${room}_objects PUBLIC ${below}_objects)
        target_link_libraries(hilda_${room} INTERFACE hilda_${below})
    endforeach()
endfunction()
