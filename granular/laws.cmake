# SPDX-License-Identifier: GPL-3.0-or-later
# Headers that CMake writes for the engine: the list of the force laws, and the build settings.

# The files that depend on the list of the laws: they call PairLaw::visit, evaluate() or for_each_kind, or write the build settings.
# In the others a law is an index and 32 bytes; added laws have the last indices of their kind. A program with added laws compiles
# these files and links the other objects of hilda-granular.
set(granular_law_files core/contact_loop_cpu.cpp core/sweep_cpu.cpp core/add_contacts.cpp core/surfaces/triangle_contacts.cpp
    world/double_world.cpp world/world_queries.cpp case/law_list.cpp case/pair_keys.cpp
    program/laws.cpp program/lammps_laws.cpp program/provenance.cpp)

# An error in one line; FATAL_ERROR would wrap it.
macro(granular_fail)
    message(NOTICE "hilda_add_granular_program: " ${ARGN})
    message(FATAL_ERROR "The laws of a granular program are wrong: see the line above.")
endmacro()

# granular_find_law(<file> <prefix>): sets <prefix>_struct and <prefix>_name of the law in a file; empty if it has none.
function(granular_find_law file prefix)
    file(READ "${file}" text)
    set(struct "")
    set(name "")
    if(text MATCHES "struct +([A-Za-z0-9_]+)[ \t\r\n]*{[ \t\r\n]*static +constexpr +const +char *\\* *name *= *\"([^\"]*)\"")
        set(struct ${CMAKE_MATCH_1})
        set(name ${CMAKE_MATCH_2})
    endif()
    set(${prefix}_struct "${struct}" PARENT_SCOPE)
    set(${prefix}_name "${name}" PARENT_SCOPE)
endfunction()

# granular_write_laws(<folder> [<added law>...]): writes <folder>/granular/force_models.hpp, which includes and lists the laws
# in force_models/KIND/ and the added ones. The file of an added law is in a folder KIND as well. The first law of a list is its
# default: `none` if there is one. Sets granular_added_laws.
function(granular_write_laws folder)
    set(root "${CMAKE_CURRENT_FUNCTION_LIST_DIR}")
    set(kinds normal tangential rolling spin cohesion)
    set(added "")
    foreach(file IN LISTS ARGN)
        get_filename_component(file "${file}" ABSOLUTE)
        if(NOT EXISTS "${file}")
            granular_fail("there is no file ${file}")
        endif()
        get_filename_component(kind "${file}" DIRECTORY)
        get_filename_component(kind "${kind}" NAME)
        if(NOT kind IN_LIST kinds)
            list(JOIN kinds ", " known)
            granular_fail("the folder of ${file} must be named after the kind of the law: "
                "${known}, got ${kind}")
        endif()
        granular_find_law("${file}" found)
        if(found_struct STREQUAL "")
            granular_fail("${file} has no law: a struct whose first member is "
                "static constexpr const char* name = \"...\"")
        endif()
        list(APPEND added_${kind} "${file}")
        list(APPEND added "${kind} ${found_name}")
    endforeach()

    set(includes "")
    set(lists "")
    set(structs "")
    foreach(kind IN LISTS kinds)
        file(GLOB files CONFIGURE_DEPENDS "${root}/force_models/${kind}/*.hpp")
        set(laws "")
        set(names "")
        foreach(file IN LISTS files added_${kind})
            set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${file}")
            granular_find_law("${file}" found)
            if(found_struct STREQUAL "") # a part of other laws
                continue()
            endif()
            if(found_name IN_LIST names)
                granular_fail("${file}: there is a ${kind} law '${found_name}' already")
            endif()
            if(found_struct IN_LIST structs)
                granular_fail("${file}: there is a struct ${found_struct} already. Choose another name")
            endif()
            list(APPEND names "${found_name}")
            list(APPEND structs "${found_struct}")
            file(RELATIVE_PATH inside "${root}" "${file}")
            if(inside MATCHES "^\\.\\.")
                string(APPEND includes "#include \"${file}\"\n")
            else()
                string(APPEND includes "#include \"granular/${inside}\"\n")
            endif()
            if(inside STREQUAL "force_models/${kind}/none.hpp")
                list(PREPEND laws ${found_struct})
            else()
                list(APPEND laws ${found_struct})
            endif()
        endforeach()
        list(JOIN laws ", " laws)
        string(SUBSTRING ${kind} 0 1 first)
        string(TOUPPER ${first} first)
        string(SUBSTRING ${kind} 1 -1 rest)
        string(APPEND lists "using ${first}${rest}Laws = AnyOf<${laws}>;\n")
    endforeach()
    file(CONFIGURE OUTPUT "${folder}/granular/force_models.hpp" CONTENT
"// Written by CMake from the files in granular/force_models.
#pragma once

@includes@
namespace hilda::granular {

@lists@
}  // namespace hilda::granular
" @ONLY)
    list(JOIN added ", " added)
    set(granular_added_laws "${added}" PARENT_SCOPE)
endfunction()

# granular_write_build(<folder> <version> <flags> <CUDA version> <added laws>): writes <folder>/granular/build.hpp, for the
# summaries of runs. The git state is determined by the build of the whole project, at every build.
function(granular_write_build folder number flags cuda added)
    string(TOUPPER "${CMAKE_BUILD_TYPE}" type)
    string(JOIN " " flags ${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${type}} ${flags})
    if(CMAKE_BUILD_TYPE STREQUAL "Release")
        string(APPEND flags " -O3")
    endif()
    file(CONFIGURE OUTPUT "${folder}/granular/build.hpp" CONTENT
"// Version and build settings. Written by CMake.
#pragma once

namespace hilda::granular::build {

inline constexpr const char* number = R\"(@number@)\";
inline constexpr const char* build_type = R\"(@CMAKE_BUILD_TYPE@)\";
inline constexpr const char* flags = R\"(@flags@)\";
inline constexpr const char* compiler = R\"(@CMAKE_CXX_COMPILER_ID@ @CMAKE_CXX_COMPILER_VERSION@)\";
inline constexpr const char* thrust = R\"(@Thrust_VERSION@)\";
inline constexpr const char* openmp = R\"(@OpenMP_CXX_VERSION@)\";
inline constexpr const char* cuda = R\"(@cuda@)\";
/// Laws that hilda_add_granular_program has added: kind and name, with commas between them
inline constexpr const char* added_laws = R\"(@added@)\";

}  // namespace hilda::granular::build
" @ONLY)
endfunction()
