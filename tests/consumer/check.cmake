# SPDX-License-Identifier: GPL-3.0-or-later
# Installs HILDA into the build folder, then configures, builds and runs the consumer with this installation.
file(REMOVE_RECURSE "${work}")

function(do what)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(NOT result EQUAL 0)
        message(FATAL_ERROR "consumer: cannot ${what} (${result}):\n${output}")
    endif()
    set(output "${output}" PARENT_SCOPE)
endfunction()

do("install hilda" ${CMAKE_COMMAND} --install "${hilda_build}" --prefix "${work}/prefix")
do("configure" ${CMAKE_COMMAND} -S "${source}" -B "${work}/build" -G "${generator}"
    "-DCMAKE_CXX_COMPILER=${compiler}" "-DCMAKE_BUILD_TYPE=${build_type}" "-DCMAKE_CXX_FLAGS=${flags}"
    "-DCMAKE_PREFIX_PATH=${work}/prefix")
do("build" ${CMAKE_COMMAND} --build "${work}/build")
do("run" "${work}/build/consumer")
message("${output}")
if(NOT output MATCHES "rA-half-1")
    message(FATAL_ERROR "consumer: the installed library does not list the integrator rA-half-1")
endif()
