# SPDX-License-Identifier: GPL-3.0-or-later
# Tests that the next build compiles a new file in lie/integrators/ without a change of any other file. Works
# on a copy of the source tree.
file(REMOVE_RECURSE "${work}")

set(files "")
if(EXISTS "${source}/.git")
    execute_process(
        COMMAND git --no-optional-locks ls-files --cached --others --exclude-standard
        WORKING_DIRECTORY "${source}" OUTPUT_VARIABLE files ERROR_QUIET)
    string(STRIP "${files}" files)
    string(REPLACE "\n" ";" files "${files}")
endif()
if(NOT files)
    file(GLOB_RECURSE files RELATIVE "${source}" "${source}/CMakeLists.txt" "${source}/LICENSE" "${source}/cmake/*")
    foreach(room io lie dae contact granular reference run studies python)
        file(GLOB_RECURSE found RELATIVE "${source}" "${source}/${room}/*")
        list(APPEND files ${found})
    endforeach()
endif()
foreach(f IN LISTS files)
    if(EXISTS "${source}/${f}" AND NOT f MATCHES "^tests/")
        get_filename_component(folder "${f}" DIRECTORY)
        file(COPY "${source}/${f}" DESTINATION "${work}/source/${folder}")
    endif()
endforeach()

function(do what)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(NOT result EQUAL 0)
        message(FATAL_ERROR "check_glob: cannot ${what} (exit code ${result}):\n${output}")
    endif()
endfunction()

do("configure the copy" ${CMAKE_COMMAND} -S "${work}/source" -B "${work}/build" -G "${generator}"
    "-DCMAKE_CXX_COMPILER=${compiler}" -DHILDA_TESTS=OFF)

get_filename_component(name "${file}" NAME)
file(COPY "${file}" DESTINATION "${work}/source/lie/integrators")
# The smallest target. Every build searches for new files first.
do("build the copy" ${CMAKE_COMMAND} --build "${work}/build" --target hilda_version)

file(READ "${work}/build/compile_commands.json" commands)
string(FIND "${commands}" "/lie/integrators/${name}" place)
if(place EQUAL -1)
    message(FATAL_ERROR "check_glob: the build did not find the new file lie/integrators/${name}")
endif()
