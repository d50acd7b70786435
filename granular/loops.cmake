# SPDX-License-Identifier: GPL-3.0-or-later
# The loops of the CPU for several instruction sets of x86-64: backend/cpu_loops.hpp, backend/instruction_set.hpp.

# The units that determine the time of a step
set(granular_loop_files backend/cpu_loops.cpp core/contact_loop_cpu.cpp core/sweep_cpu.cpp core/add_contacts.cpp
    core/surfaces/triangle_contacts.cpp)

# granular_can_dispatch(<variable>): whether the build can have them. Needs GNU binutils and GCC. A build for one processor, a
# build with sanitizers and one for clang-tidy have the units once.
function(granular_can_dispatch variable)
    set(can OFF)
    if(CMAKE_SYSTEM_NAME STREQUAL "Linux" AND CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$" AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU"
            AND CMAKE_OBJCOPY AND CMAKE_LINKER AND NOT HILDA_NATIVE AND NOT HILDA_SANITIZE
            AND NOT CMAKE_CXX_CLANG_TIDY AND NOT CMAKE_CXX_FLAGS MATCHES "-march=")
        set(can ON)
    endif()
    set(${variable} ${can} PARENT_SCOPE)
endfunction()

# granular_compile_loops(<name> <root> <variable> INCLUDES <folder>... FLAGS <flag>...): compiles the units in <root> for x86-64-v3
# and x86-64-v4, and sets <variable> to the object files. The target <name>_loops makes them.
#
# The units of an instruction set are linked into one object file, in which only the function that returns the table of the loops
# remains global. Otherwise the linker could take an inline function that they share with other units, as those of std::vector,
# from them, and the program would execute instructions that the processor does not have.
function(granular_compile_loops name root variable)
    cmake_parse_arguments(PARSE_ARGV 3 arg "" "" "INCLUDES;FLAGS")
    list(TRANSFORM granular_loop_files PREPEND "${root}/" OUTPUT_VARIABLE sources)
    set(objects "")
    # GCC copies structures in parts of 128 bits by default. A load of 256 bits behind such a store waits until it is in the cache.
    set(move_v3 -mmove-max=256 -mstore-max=256)
    # It zeroes structures of more than 128 bytes with rep stos, which takes a twentieth of a step of 10 000 particles.
    set(move_v4 -mmove-max=512 -mstore-max=512 -mmemset-strategy=vector_loop:2048:noalign,libcall:-1:noalign)
    foreach(set v3 v4)
        set(target ${name}_${set})
        # An archive, not an object library: of the latter's files the generator Make knows no rule outside of their target.
        add_library(${target} STATIC EXCLUDE_FROM_ALL ${sources})
        target_include_directories(${target} PRIVATE ${arg_INCLUDES})
        target_compile_features(${target} PRIVATE cxx_std_20)
        target_compile_definitions(${target} PRIVATE HILDA_LOOPS=${set})
        # Without the warnings that the intrinsics of AVX-512 cause (GCC bug 105593)
        target_compile_options(${target} PRIVATE
            ${arg_FLAGS} -march=x86-64-${set} ${move_${set}} -fno-gnu-unique -Wno-psabi -Wno-maybe-uninitialized -Wno-uninitialized)
        target_link_libraries(${target} PRIVATE granular_thrust_target OpenMP::OpenMP_CXX)
        set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON UNITY_BUILD OFF)
        set(object "${CMAKE_CURRENT_BINARY_DIR}/${target}.o")
        add_custom_command(OUTPUT "${object}"
            COMMAND ${CMAKE_LINKER} -r --force-group-allocation -o "${object}.global" --whole-archive $<TARGET_FILE:${target}>
            COMMAND ${CMAKE_OBJCOPY} --keep-global-symbol=hilda_granular_loops_${set} "${object}.global" "${object}"
            COMMAND ${CMAKE_COMMAND} -E rm "${object}.global"
            DEPENDS ${target} VERBATIM)
        list(APPEND objects "${object}")
    endforeach()
    add_custom_target(${name}_loops DEPENDS ${objects})
    set_source_files_properties(${objects} PROPERTIES EXTERNAL_OBJECT TRUE GENERATED TRUE)
    set(${variable} "${objects}" PARENT_SCOPE)
endfunction()
