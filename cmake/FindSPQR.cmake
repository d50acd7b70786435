# SPDX-License-Identifier: GPL-3.0-or-later
# SuiteSparseQR, the sparse rank-revealing QR factorisation of SuiteSparse. SuiteSparse 5 has no CMake
# package. Defines the target SPQR::SPQR and SPQR_VERSION.
include(FindPackageHandleStandardArgs)

find_path(SPQR_INCLUDE_DIR SuiteSparseQR.hpp PATH_SUFFIXES suitesparse)
set(_spqr_libraries "")
foreach(_spqr_part spqr cholmod suitesparseconfig)
    find_library(SPQR_${_spqr_part}_LIBRARY ${_spqr_part})
    list(APPEND _spqr_libraries SPQR_${_spqr_part}_LIBRARY)
endforeach()

if(SPQR_INCLUDE_DIR AND EXISTS "${SPQR_INCLUDE_DIR}/SuiteSparseQR_definitions.h")
    set(_spqr_digits "")
    foreach(_spqr_part MAIN SUB SUBSUB)
        file(STRINGS "${SPQR_INCLUDE_DIR}/SuiteSparseQR_definitions.h" _spqr_line
            REGEX "define[ \t]+SPQR_${_spqr_part}_VERSION[ \t]")
        string(REGEX MATCH "[0-9]+" _spqr_digit "${_spqr_line}")
        list(APPEND _spqr_digits ${_spqr_digit})
    endforeach()
    list(JOIN _spqr_digits "." SPQR_VERSION)
endif()

find_package_handle_standard_args(SPQR REQUIRED_VARS SPQR_INCLUDE_DIR ${_spqr_libraries} VERSION_VAR SPQR_VERSION)

if(SPQR_FOUND AND NOT TARGET SPQR::SPQR)
    add_library(SPQR::SPQR UNKNOWN IMPORTED)
    set_target_properties(SPQR::SPQR PROPERTIES
        IMPORTED_LOCATION "${SPQR_spqr_LIBRARY}"
        INTERFACE_INCLUDE_DIRECTORIES "${SPQR_INCLUDE_DIR}"
        INTERFACE_LINK_LIBRARIES "${SPQR_cholmod_LIBRARY};${SPQR_suitesparseconfig_LIBRARY}")
endif()
mark_as_advanced(SPQR_INCLUDE_DIR ${_spqr_libraries})
