# SPDX-License-Identifier: GPL-3.0-or-later
# A part of the installed package: hilda_add_granular_program(NAME [LAWS FILE...]), the program hilda-granular under another name,
# with added force laws.
#
# FILE is KIND/x.hpp, with KIND one of normal, tangential, rolling, spin and cohesion, and contains a law as the files in
# granular/force_models/KIND do: a functor, which is compiled into the contact loops of the CPU and, if nvcc is found, of the GPU. The
# program reads the laws from case files, and `NAME laws` and `NAME schema` list them. HILDA_CUDA=OFF builds without GPU support.
#
# hilda_granular_parts: the objects of hilda-granular that do not depend on the laws (granular_law_files).
set(hilda_granular_root "${CMAKE_CURRENT_LIST_DIR}")
include("${hilda_granular_root}/laws.cmake")
include("${hilda_granular_root}/loops.cmake")
include("${hilda_granular_root}/dependencies.cmake")

# A macro, because enable_language must be called at file scope.
macro(hilda_add_granular_program)
    option(HILDA_CUDA "Build granular programs with GPU support if nvcc is found" ON)
    granular_find_dependencies()
    include("${hilda_granular_root}/cuda.cmake")
    granular_add_program(${ARGV})
endmacro()

function(granular_add_program name)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "LAWS")
    if(arg_UNPARSED_ARGUMENTS)
        granular_fail("unknown argument ${arg_UNPARSED_ARGUMENTS}. The files of laws follow LAWS")
    endif()
    set(root "${hilda_granular_root}")
    set(generated "${CMAKE_CURRENT_BINARY_DIR}/${name}-generated")
    set(flags -ffp-contract=off -fno-math-errno -fno-trapping-math)
    granular_write_laws("${generated}" ${arg_LAWS})
    granular_write_build("${generated}" "${hilda_VERSION}" "${flags}" "${granular_cuda}" "${granular_added_laws}")

    list(TRANSFORM granular_law_files PREPEND "${root}/" OUTPUT_VARIABLE sources)
    if(granular_cuda)
        list(APPEND sources "${root}/backend/engine_gpu.cu")
    else()
        list(APPEND sources "${root}/backend/engine_no_gpu.cpp")
    endif()
    add_executable(${name} ${sources})
    target_include_directories(${name} BEFORE PRIVATE "${generated}" "${root}/.." ${hilda_granular_headers})
    target_compile_features(${name} PRIVATE cxx_std_20)
    # The flags of hilda-granular, so that both programs give the same bytes.
    target_compile_options(${name} PRIVATE
        "$<$<COMPILE_LANGUAGE:CXX>:${flags};-Wno-psabi>" "$<$<AND:$<COMPILE_LANGUAGE:CXX>,$<NOT:$<CONFIG:Debug>>>:-O3>")
    if(hilda_granular_dispatch) # the objects in hilda_granular_parts refer to the loops for all instruction sets
        granular_compile_loops(${name} "${root}" loops INCLUDES "${generated}" "${root}/.." ${hilda_granular_headers}
            FLAGS ${flags} $<$<NOT:$<CONFIG:Debug>>:-O3>)
        target_sources(${name} PRIVATE ${loops})
    endif()
    target_link_libraries(${name} PRIVATE "$<LINK_LIBRARY:WHOLE_ARCHIVE,${hilda_granular_parts}>"
        granular_thrust_target OpenMP::OpenMP_CXX CLI11::CLI11)
    if(granular_cuda)
        set_target_properties(${name} PROPERTIES CUDA_STANDARD 20 CUDA_STANDARD_REQUIRED ON)
        target_compile_options(${name} PRIVATE "$<$<COMPILE_LANGUAGE:CUDA>:${granular_cuda_flags}>")
        target_link_libraries(${name} PRIVATE CUDA::cudart_static)
    endif()
endfunction()
