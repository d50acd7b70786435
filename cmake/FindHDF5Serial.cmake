# SPDX-License-Identifier: GPL-3.0-or-later
# The C library of HDF5 without MPI: HDF5Serial_LIBRARY, HDF5Serial_INCLUDE_DIR, HDF5Serial_VERSION.
#
# Not FindHDF5 of CMake: it needs the language C, and takes the MPI version if no other is installed. Debian installs both
# versions side by side, in hdf5/serial and hdf5/openmpi.
find_path(HDF5Serial_INCLUDE_DIR hdf5.h HINTS "${HDF5_ROOT}/include" "$ENV{HDF5_ROOT}/include" PATH_SUFFIXES hdf5/serial)
find_library(HDF5Serial_LIBRARY NAMES hdf5_serial hdf5 HINTS "${HDF5_ROOT}/lib" "$ENV{HDF5_ROOT}/lib"
    PATH_SUFFIXES hdf5/serial)
mark_as_advanced(HDF5Serial_INCLUDE_DIR HDF5Serial_LIBRARY)

unset(HDF5Serial_VERSION)
set(HDF5Serial_is_serial FALSE)
foreach(hdf5_header H5pubconf.h H5pubconf-64.h)
    if(HDF5Serial_INCLUDE_DIR AND EXISTS "${HDF5Serial_INCLUDE_DIR}/${hdf5_header}")
        file(STRINGS "${HDF5Serial_INCLUDE_DIR}/${hdf5_header}" hdf5_lines
            REGEX "^#define H5_(PACKAGE_VERSION|HAVE_PARALLEL) ")
        if(hdf5_lines MATCHES "H5_PACKAGE_VERSION \"([0-9.]+)")
            set(HDF5Serial_VERSION "${CMAKE_MATCH_1}")
            if(NOT hdf5_lines MATCHES "H5_HAVE_PARALLEL 1")
                set(HDF5Serial_is_serial TRUE)
            endif()
        endif()
    endif()
endforeach()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(HDF5Serial
    REQUIRED_VARS HDF5Serial_LIBRARY HDF5Serial_INCLUDE_DIR HDF5Serial_is_serial
    VERSION_VAR HDF5Serial_VERSION)
