# SPDX-License-Identifier: GPL-3.0-or-later
# KLU, the sparse LU factorisation of SuiteSparse, and AMD, its ordering. SuiteSparse 5 has no CMake package.
# Defines the target KLU::KLU and KLU_VERSION.
include(FindPackageHandleStandardArgs)

find_path(KLU_INCLUDE_DIR klu.h PATH_SUFFIXES suitesparse)
set(_klu_libraries "")
foreach(_klu_part klu btf amd colamd suitesparseconfig)
    find_library(KLU_${_klu_part}_LIBRARY ${_klu_part})
    list(APPEND _klu_libraries KLU_${_klu_part}_LIBRARY)
endforeach()

if(KLU_INCLUDE_DIR AND EXISTS "${KLU_INCLUDE_DIR}/klu.h")
    set(_klu_digits "")
    foreach(_klu_part MAIN SUB SUBSUB)
        file(STRINGS "${KLU_INCLUDE_DIR}/klu.h" _klu_line REGEX "define[ \t]+KLU_${_klu_part}_VERSION[ \t]")
        string(REGEX MATCH "[0-9]+" _klu_digit "${_klu_line}")
        list(APPEND _klu_digits ${_klu_digit})
    endforeach()
    list(JOIN _klu_digits "." KLU_VERSION)
endif()

find_package_handle_standard_args(KLU REQUIRED_VARS KLU_INCLUDE_DIR ${_klu_libraries} VERSION_VAR KLU_VERSION)

if(KLU_FOUND AND NOT TARGET KLU::KLU)
    add_library(KLU::KLU UNKNOWN IMPORTED)
    set_target_properties(KLU::KLU PROPERTIES
        IMPORTED_LOCATION "${KLU_klu_LIBRARY}"
        INTERFACE_INCLUDE_DIRECTORIES "${KLU_INCLUDE_DIR}"
        INTERFACE_LINK_LIBRARIES
            "${KLU_btf_LIBRARY};${KLU_amd_LIBRARY};${KLU_colamd_LIBRARY};${KLU_suitesparseconfig_LIBRARY}")
endif()
mark_as_advanced(KLU_INCLUDE_DIR ${_klu_libraries})
