# SPDX-License-Identifier: GPL-3.0-or-later
# hilda_add_plugin(NAME SOURCE...): a shared library NAME.so for `hilda --load NAME.so`.
#
# Its sources register integrators, joints, forces, surfaces, laws, problems, studies or outputs as the files of HILDA do.
# It is not linked with a library of HILDA: it uses the functions of the program that loads it.
set(_hilda_plugin_dir "${CMAKE_CURRENT_LIST_DIR}")

function(hilda_add_plugin name)
    add_library(${name} MODULE ${ARGN} "${_hilda_plugin_dir}/plugin_interface.cpp")
    set_target_properties(${name} PROPERTIES PREFIX "" CXX_VISIBILITY_PRESET default)
    target_compile_features(${name} PRIVATE cxx_std_20)
    foreach(library hilda::hilda Eigen3::Eigen KLU::KLU SPQR::SPQR fmt::fmt)
        target_include_directories(${name} SYSTEM PRIVATE
            $<TARGET_PROPERTY:${library},INTERFACE_INCLUDE_DIRECTORIES>)
        target_compile_options(${name} PRIVATE $<TARGET_PROPERTY:${library},INTERFACE_COMPILE_OPTIONS>)
        target_compile_definitions(${name} PRIVATE $<TARGET_PROPERTY:${library},INTERFACE_COMPILE_DEFINITIONS>)
    endforeach()
    # As in the program: without fused multiply-add, results do not depend on the processor.
    target_compile_options(${name} PRIVATE -ffp-contract=off -fno-math-errno -fno-trapping-math)
endfunction()
