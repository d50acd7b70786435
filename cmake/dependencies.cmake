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
hilda_find(libcli11-dev CLI11 CONFIG)
hilda_find(libc6-dev Threads)
hilda_find(g++ OpenMP COMPONENTS CXX)
if(HILDA_TESTS)
    hilda_find(catch2 Catch2 2.13 CONFIG)
    hilda_find(nlohmann-json3-dev nlohmann_json 3.11 CONFIG)
endif()

# hilda_find_optional(<option> <what it is for> <message if it is missing> <Debian package> <arguments of find_package>...): a library
# that the build uses if it is found (AUTO), requires (ON) or leaves out (OFF). Sets <name>_FOUND.
macro(hilda_find_optional option help missing debian name)
    set(${option} AUTO CACHE STRING "${help}: AUTO (if the library is found), ON or OFF")
    set_property(CACHE ${option} PROPERTY STRINGS AUTO ON OFF)
    if(${option} STREQUAL "AUTO")
        find_package(${name} ${ARGN} QUIET)
        if(${name}_FOUND)
            message(STATUS "${name} ${${name}_VERSION}")
        else()
            message(STATUS "${name} was not found: ${missing} (Debian: apt-get install ${debian})")
        endif()
    elseif(${option})
        hilda_find(${debian} ${name} ${ARGN})
    else()
        set(${name}_FOUND FALSE)
    endif()
endmacro()

if(HILDA_TESTS OR HILDA_WITH_PYTHON STREQUAL "ON")
    set(HILDA_WITH_GRAINS ON) # they use all rooms
endif()
hilda_find_optional(HILDA_WITH_GRAINS "Grains: hilda-granular, co-simulation, their studies" "there are no grains"
    libthrust-dev Thrust 1.17 CONFIG)
hilda_find_optional(HILDA_WITH_HDF5 "Tables in HDF5 files" "hilda run has no --format hdf5" libhdf5-dev HDF5Serial 1.10.2)
# Open MPI: the program reads its environment variables.
set(MPI_CXX_SKIP_MPICXX TRUE)
hilda_find_optional(HILDA_WITH_MPI "Several processes under mpirun" "hilda-granular and hilda cosim do not run under mpirun" libopenmpi-dev MPI 3.1 COMPONENTS CXX)

hilda_find_optional(HILDA_WITH_URDF "Import of URDF files" "hilda import reads no URDF files" liburdfdom-dev Urdfdom)
hilda_find_optional(HILDA_WITH_MJCF "Import of MJCF files" "hilda import reads no MJCF files" libmujoco-dev MuJoCo 2.2)

# Figures need a Python with matplotlib. On Debian this is /usr/bin/python3; another python3 may be first in
# PATH.
if(EXISTS /usr/bin/python3)
    set(hilda_python_default /usr/bin/python3)
else()
    set(hilda_python_default python3)
endif()
set(HILDA_PYTHON "${hilda_python_default}" CACHE STRING "Python with matplotlib, for the figures and the Python package")

# The Python package, which needs NumPy at run time. A library of the address sanitizer would have to be loaded before Python.
set(HILDA_WITH_PYTHON AUTO CACHE STRING "Python package: AUTO (if pybind11 and the headers of Python are found), ON or OFF")
set_property(CACHE HILDA_WITH_PYTHON PROPERTY STRINGS AUTO ON OFF)
set(hilda_has_python FALSE)
if(HILDA_WITH_PYTHON AND Thrust_FOUND AND NOT HILDA_SANITIZE)
    set(Python_EXECUTABLE "${HILDA_PYTHON}")
    find_package(Python 3.11 QUIET COMPONENTS Interpreter Development.Module)
    if(Python_FOUND)
        set(PYBIND11_FINDPYTHON ON)
        find_package(pybind11 2.10 CONFIG QUIET)
    endif()
    # The build does not need NumPy, and pip hides it. The tests do.
    execute_process(COMMAND "${HILDA_PYTHON}" -c "import numpy" RESULT_VARIABLE no_numpy OUTPUT_QUIET ERROR_QUIET)
    if(pybind11_FOUND AND (NOT no_numpy OR NOT HILDA_WITH_PYTHON STREQUAL "AUTO"))
        message(STATUS "pybind11 ${pybind11_VERSION}, Python ${Python_VERSION}")
        set(hilda_has_python TRUE)
    elseif(HILDA_WITH_PYTHON STREQUAL "AUTO")
        message(STATUS "pybind11, NumPy or the headers of Python 3.11 were not found: no Python package (Debian: apt-get install pybind11-dev python3-dev python3-numpy)")
    else()
        list(APPEND hilda_missing "pybind11 and Python 3.11")
        list(APPEND hilda_missing_debian pybind11-dev python3-dev python3-numpy)
    endif()
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
