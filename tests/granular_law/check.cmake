# SPDX-License-Identifier: GPL-3.0-or-later
# Installs HILDA, writes a granular law with the installed program, builds it against the installation, and tests it.
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE "${work}")

function(do what)
    execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
    if(NOT result EQUAL 0)
        message(FATAL_ERROR "granular law: cannot ${what} (${result}):\n${output}")
    endif()
endfunction()
set(settings -G "${generator}" "-DCMAKE_CXX_COMPILER=${compiler}" "-DCMAKE_BUILD_TYPE=${build_type}"
    "-DCMAKE_PREFIX_PATH=${work}/prefix")
# The paths are always the same: a compiler cache has the objects of the last run.
if(launcher)
    set(ENV{CMAKE_CXX_COMPILER_LAUNCHER} "${launcher}")
    set(ENV{CMAKE_CUDA_COMPILER_LAUNCHER} "${launcher}")
endif()

do("install hilda" ${CMAKE_COMMAND} --install "${hilda_build}" --prefix "${work}/prefix")
do("write a new law" "${work}/prefix/bin/hilda" new granular-law two-slopes --output "${work}/law")
# A cohesion law beside it: a constant attraction that is given per radius
file(WRITE "${work}/law/cohesion/per_radius.hpp" "\
#include \"granular/core/contact_point.hpp\"
namespace hilda::granular {
struct PerRadius
{
    static constexpr const char *name = \"per-radius\";
    static constexpr const char* description = \"Attraction f R*.\";
    static constexpr const char* example = R\"(\"f\": 1)\";
    float f = 0;
    template <class R>
    HILDA_HD R operator()(const ContactPoint<R>& contact) const { return f * contact.R_eff; }
    template <class Keys>
    static PerRadius read(Keys& keys) { return {.f = keys.not_negative(\"f\", 0, \"Force per radius f [N/m].\", 1)}; }
};
}
")
file(APPEND "${work}/law/CMakeLists.txt" "
set(HILDA_CUDA OFF) # the GPU is the same
hilda_add_granular_program(with-two LAWS normal/two_slopes.hpp cohesion/per_radius.hpp)
")
do("configure" ${CMAKE_COMMAND} -S "${work}/law" -B "${work}/law/build" ${settings})
do("build" ${CMAKE_COMMAND} --build "${work}/law/build" --parallel 2)
do("pass the test" "${python}" "${source}/law_test.py" "${work}/prefix/bin/hilda-granular" "${work}/law")

# What is refused when the project is configured, each with one line
function(refused laws reason)
    file(WRITE "${work}/refused/CMakeLists.txt" "cmake_minimum_required(VERSION 3.25)\nproject(refused LANGUAGES CXX)\n"
        "find_package(hilda 0.2 CONFIG REQUIRED COMPONENTS granular_program)\n"
        "hilda_add_granular_program(refused ${laws})\n")
    execute_process(COMMAND ${CMAKE_COMMAND} -S "${work}/refused" -B "${work}/refused/build" ${settings} -DHILDA_CUDA=OFF
        RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
    string(FIND "${output}" "${reason}" found)
    if(result EQUAL 0 OR found EQUAL -1)
        message(FATAL_ERROR "granular law: '${laws}' must be refused because: ${reason}. Exit code ${result}:\n${output}")
    endif()
endfunction()
file(WRITE "${work}/refused/normal/second_hertz.hpp" "struct SecondHertz { static constexpr const char* name = \"hertz\"; };\n")
file(WRITE "${work}/refused/normal/hertz.hpp" "struct Hertz { static constexpr const char* name = \"my-hertz\"; };\n")
file(WRITE "${work}/refused/normal/empty.hpp" "struct Empty { int k; };\n")
file(WRITE "${work}/refused/norml/law.hpp" "struct Law { static constexpr const char* name = \"law\"; };\n")
refused("LAWS normal/missing.hpp" "there is no file ${work}/refused/normal/missing.hpp")
refused("LAWS normal/empty.hpp" "/normal/empty.hpp has no law: a struct whose first member is static constexpr const char* name")
refused("LAWS normal/second_hertz.hpp" "there is a normal law 'hertz' already")
refused("LAWS normal/hertz.hpp" "there is a struct Hertz already")
refused("LAWS norml/law.hpp" "must be named after the kind of the law: normal, tangential, rolling, spin, cohesion, got norml")
refused("normal/hertz.hpp" "unknown argument normal/hertz.hpp. The files of laws follow LAWS")

# The files that depend on the list of the laws are those that a program with added laws compiles.
include("${source}/../../granular/laws.cmake")
file(GLOB_RECURSE files RELATIVE "${source}/../../granular" "${source}/../../granular/*.cpp")
foreach(file IN LISTS files)
    file(STRINGS "${source}/../../granular/${file}" uses REGEX "[.]visit\\(|for_each_kind|granular::evaluate|[ =]evaluate\\(law|[.]is<")
    if(uses AND NOT file IN_LIST granular_law_files)
        message(FATAL_ERROR "granular law: ${file} depends on the list of the laws: ${uses}. Add it to granular_law_files")
    endif()
endforeach()
