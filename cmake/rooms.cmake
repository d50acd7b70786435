# SPDX-License-Identifier: GPL-3.0-or-later
# How a room becomes targets.

# Five precompiled headers: one owned by the lowest room with Eigen and used by the rooms below run, one by run and used by studies, one
# by the tests of the lowest room and used by all tests, and those of granular and of its tests, without Eigen and with the flags of
# granular. A source file must include what it uses: the preset `tidy` builds without precompiled headers.
#
# The optimisation is part of a precompiled header, so it is set here as well. Run, studies and tests are compiled with -O1 in a Release
# build, a quarter less time.
#
# nlohmann/json.hpp, which tests use, is not part of them. Its literal operators instantiate the parser, which costs 0.6 s in
# each file that sees the header, and most files do not use it. Headers with compile definitions (fmt) cannot be part of them,
# because the definitions differ between the rooms.
function(hilda_precompile target)
    if(target MATCHES "^(test_|run_|studies_|program_)")
        # Without the warnings that -O1 of GCC 12 falsely gives for matrices of Eigen, and with -O2 and -O3 not.
        target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1$<SEMICOLON>-Wno-maybe-uninitialized>)
    endif()
    list(TRANSFORM hilda_optimised_rooms APPEND "_objects" OUTPUT_VARIABLE optimised)
    if(target IN_LIST optimised)
        target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O3>)
    endif()
    if(NOT HILDA_PCH)
        return()
    endif()
    set(headers <Eigen/Dense> <algorithm> <cmath> <functional> <map> <memory> <sstream> <string> <vector>)
    if(target MATCHES "^(test_)?granular_objects$")
        list(REMOVE_ITEM headers <Eigen/Dense>)
        if(target MATCHES "^test_")
            list(APPEND headers <catch2/catch.hpp>)
        else()
            # GCC 12 reports false positives in std::string of a precompiled header with -O3.
            target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overread>)
        endif()
        target_precompile_headers(${target} PRIVATE ${headers})
        hilda_name_precompiled_header(${target})
    elseif(target MATCHES "^(lie|run)_objects$")
        target_precompile_headers(${target} PRIVATE ${headers})
        hilda_name_precompiled_header(${target})
    elseif(target STREQUAL "test_lie_objects")
        target_precompile_headers(${target} PRIVATE ${headers} <catch2/catch.hpp>)
        hilda_name_precompiled_header(${target})
    elseif(target MATCHES "^test_")
        target_precompile_headers(${target} REUSE_FROM test_lie_objects)
    elseif(target MATCHES "^(studies|program)_")
        target_precompile_headers(${target} REUSE_FROM run_objects)
    else()
        target_precompile_headers(${target} REUSE_FROM lie_objects)
    endif()
endfunction()

# hilda_unity(<target> [TOGETHER "<folder>..."...] [ALONE <file>...]): with HILDA_UNITY the files of a folder are compiled in
# batches of at most eight. The files of the folders that an entry of TOGETHER lists ("." is that of the target) are one batch. The
# headers and what they instantiate, most of the time of a small file, then cost once. Files whose names would collide (ALONE)
# are compiled by themselves, and so are those with properties of their own. Two cores are busy to the end if no batch takes more
# than half a minute.
#
# Names in the unnamed namespaces of a batch must differ. Files with the same short symbols have a named namespace around the
# unnamed one.
function(hilda_unity target)
    if(NOT HILDA_UNITY)
        return()
    endif()
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "TOGETHER;ALONE")
    get_target_property(files ${target} SOURCES)
    get_target_property(folder ${target} SOURCE_DIR)
    list(SORT files)  # the subfolders are between the files of a folder
    foreach(file IN LISTS files)
        get_filename_component(file "${file}" ABSOLUTE BASE_DIR "${folder}")
        file(RELATIVE_PATH name "${folder}" "${file}")
        if(NOT name MATCHES "[.]cpp$" OR name IN_LIST arg_ALONE)
            continue()
        endif()
        get_filename_component(of_file "${name}" DIRECTORY)
        if(NOT of_file)
            set(of_file ".")
        endif()
        set(group "")
        foreach(together IN LISTS arg_TOGETHER)
            separate_arguments(folders UNIX_COMMAND "${together}")
            if(of_file IN_LIST folders)
                list(GET folders 0 first)
                string(MAKE_C_IDENTIFIER "${first}_together" group)
            endif()
        endforeach()
        if(NOT group)
            string(MAKE_C_IDENTIFIER "count_${of_file}" count)
            if(NOT DEFINED ${count})
                set(${count} 0)
            endif()
            math(EXPR batch "${${count}} / 8")
            math(EXPR ${count} "${${count}} + 1")
            string(MAKE_C_IDENTIFIER "${of_file}_${batch}" group)
        endif()
        set_source_files_properties("${file}" TARGET_DIRECTORY ${target} PROPERTIES UNITY_GROUP "${group}")
    endforeach()
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
endfunction()

# hilda_room(<room> SOURCES <file>... [ROOMS <room>...] [LIBRARIES <target>...] [TOGETHER "<folder>..."...] [ALONE <file>...])
#
#   TOGETHER, ALONE see hilda_unity
#   <room>_objects  the compiled files; link this to compile against the room
#   hilda_<room>    the room with its objects and all rooms below; link this to make a program
#
# Object libraries, not archives: an archive drops the object files that nobody calls, and the list of schemes
# would be empty. A program that reaches a room by two paths still gets its objects once.
function(hilda_room room)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;ROOMS;LIBRARIES;TOGETHER;ALONE")

    add_library(${room}_objects OBJECT ${arg_SOURCES})
    target_include_directories(${room}_objects PUBLIC "${PROJECT_SOURCE_DIR}")
    target_link_libraries(${room}_objects PUBLIC ${arg_LIBRARIES})
    hilda_precompile(${room}_objects)
    hilda_unity(${room}_objects TOGETHER ${arg_TOGETHER} ALONE ${arg_ALONE})

    add_library(hilda_${room} INTERFACE)
    target_sources(hilda_${room} INTERFACE $<TARGET_OBJECTS:${room}_objects>)
    target_include_directories(hilda_${room} INTERFACE "${PROJECT_SOURCE_DIR}")
    target_link_libraries(hilda_${room} INTERFACE ${arg_LIBRARIES})

    foreach(below IN LISTS arg_ROOMS)
        target_link_libraries(${room}_objects PUBLIC ${below}_objects)
        target_link_libraries(hilda_${room} INTERFACE hilda_${below})
    endforeach()
endfunction()
