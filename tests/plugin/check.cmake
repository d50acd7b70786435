# SPDX-License-Identifier: GPL-3.0-or-later
# Installs HILDA, builds the plug-ins against the installation, and tests them with the installed program.
file(REMOVE_RECURSE "${work}")

function(do what)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(NOT result EQUAL 0)
        message(FATAL_ERROR "plug-in: cannot ${what} (${result}):\n${output}")
    endif()
endfunction()

do("install hilda" ${CMAKE_COMMAND} --install "${hilda_build}" --prefix "${work}/prefix")
do("configure" ${CMAKE_COMMAND} -S "${source}" -B "${work}/build" -G "${generator}"
    "-DCMAKE_CXX_COMPILER=${compiler}" "-DCMAKE_BUILD_TYPE=${build_type}" "-DCMAKE_CXX_FLAGS=${flags}"
    "-DCMAKE_PREFIX_PATH=${work}/prefix")
do("build" ${CMAKE_COMMAND} --build "${work}/build" --parallel 2)
do("write a new integrator" "${work}/prefix/bin/hilda" new integrator test-heun --output "${work}/new")
do("configure the new integrator" ${CMAKE_COMMAND} -S "${work}/new" -B "${work}/new/build" -G "${generator}"
    "-DCMAKE_CXX_COMPILER=${compiler}" "-DCMAKE_BUILD_TYPE=${build_type}" "-DCMAKE_CXX_FLAGS=${flags}"
    "-DCMAKE_PREFIX_PATH=${work}/prefix")
do("build the new integrator" ${CMAKE_COMMAND} --build "${work}/new/build")
do("find the second order of the new integrator" "${work}/prefix/bin/hilda" --load "${work}/new/build/test-heun.so"
    study convergence --problem double_pendulum_moving,n_pendulum_2_spin --integrator test-heun
    --steps 1e-3,5e-4,2.5e-4 --no-plot --output "${work}/order" --expect order_r=2+-0.1 --expect order_Q=2+-0.15)
do("pass the test" "${python}" "${source}/plugin_test.py" "${work}/prefix/bin/hilda" "${work}/build")
