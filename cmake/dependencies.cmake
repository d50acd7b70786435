# SPDX-License-Identifier: GPL-3.0-or-later
# Required libraries. All of them are searched before an error, so that one message lists all missing ones.

set(hilda_missing "")
set(hilda_missing_debian "")

# hilda_find(<Debian package> <arguments of find_package>...)
macro(hilda_find debian name)
    find_package(${name} ${ARGN} QUIET)
    if(${name}_FOUND)
        message(STATUS "${name} ${${name}_VERSION}")
    else()
        string(REGEX MATCH "^[0-9.]+" hilda_wanted "${ARGN}")
        string(STRIP "${name} ${hilda_wanted}" hilda_wanted)
        list(APPEND hilda_missing "${hilda_wanted}")
        list(APPEND hilda_missing_debian ${debian})
    endif()
endmacro()

set(THREADS_PREFER_PTHREAD_FLAG ON)
hilda_find(libeigen3-dev Eigen3 3.4 CONFIG)
hilda_find(libsuitesparse-dev KLU 1.3)
hilda_find(libsuitesparse-dev SPQR 2.0)
hilda_find(libgsl-dev GSL 2.7)
hilda_find(libsundials-dev SUNDIALS 6.4 CONFIG COMPONENTS ida nvecserial sunmatrixsparse sunlinsolklu)
hilda_find(libfmt-dev fmt CONFIG)
hilda_find(libspdlog-dev spdlog CONFIG)
hilda_find(libcli11-dev CLI11 CONFIG)
hilda_find(libc6-dev Threads)
hilda_find(g++ OpenMP COMPONENTS CXX)
hilda_find(libthrust-dev Thrust 1.17 CONFIG)
if(HILDA_TESTS)
    hilda_find(catch2 Catch2 2.13 CONFIG)
    hilda_find(nlohmann-json3-dev nlohmann_json 3.11 CONFIG)
endif()

# Optional: hilda run --format hdf5. With AUTO the program is built without it where it is not installed.
set(HILDA_WITH_HDF5 AUTO CACHE STRING "Tables in HDF5 files: AUTO (if the library is found), ON or OFF")
set_property(CACHE HILDA_WITH_HDF5 PROPERTY STRINGS AUTO ON OFF)
if(HILDA_WITH_HDF5 STREQUAL "AUTO")
    find_package(HDF5Serial 1.10.2 QUIET)
    if(HDF5Serial_FOUND)
        message(STATUS "HDF5Serial ${HDF5Serial_VERSION}")
    else()
        message(STATUS "HDF5 was not found: hilda run has no --format hdf5 (Debian: apt-get install libhdf5-dev)")
    endif()
elseif(HILDA_WITH_HDF5)
    hilda_find(libhdf5-dev HDF5Serial 1.10.2)
else()
    set(HDF5Serial_FOUND FALSE)
endif()

if(hilda_missing)
    list(REMOVE_DUPLICATES hilda_missing_debian)
    list(JOIN hilda_missing ", " hilda_missing)
    list(JOIN hilda_missing_debian " " hilda_missing_debian)
    # NOTICE keeps the message on one line; FATAL_ERROR would wrap it.
    message(NOTICE "hilda: missing: ${hilda_missing} (Debian: apt-get install ${hilda_missing_debian})")
    message(FATAL_ERROR "Libraries are missing: see the line above.")
endif()

# Optional: used by studies/benchmarks only.
find_package(benchmark CONFIG QUIET)

# Figures need a Python with matplotlib. On Debian this is /usr/bin/python3; another python3 may be first in
# PATH.
if(EXISTS /usr/bin/python3)
    set(hilda_python_default /usr/bin/python3)
else()
    set(hilda_python_default python3)
endif()
set(HILDA_PYTHON "${hilda_python_default}" CACHE STRING "Python with matplotlib, for the figures")
