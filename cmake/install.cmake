# SPDX-License-Identifier: GPL-3.0-or-later
# Installs libhilda.so (the rooms io, lie, dae, contact and run), one library for each of granular, reference and studies, the
# headers, the programs, and a package for find_package(hilda CONFIG). libhilda.so and libhilda_granular.so do not use GSL.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(hilda_package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/hilda")

# The Debian packages (package.cmake): libraries, programs, python, doc, and dev for everything else
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME dev)

# The objects of fits, which need GSL: they are in libhilda_studies.so.
set(hilda_fits "/run_objects[.]dir/.*fitting[^/]*$|/run_objects[.]dir/fitting/")

# The target is not named `hilda`, the name of the program in the build folder.
add_library(hilda_library SHARED
    $<TARGET_OBJECTS:io_objects> $<TARGET_OBJECTS:lie_objects> $<TARGET_OBJECTS:dae_objects> $<TARGET_OBJECTS:contact_objects>
    "$<FILTER:$<TARGET_OBJECTS:run_objects>,EXCLUDE,${hilda_fits}>")
add_library(hilda::hilda ALIAS hilda_library)
set_target_properties(hilda_library PROPERTIES
    OUTPUT_NAME hilda
    EXPORT_NAME hilda
    VERSION ${PROJECT_VERSION}
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
target_compile_features(hilda_library PUBLIC cxx_std_20)
target_include_directories(hilda_library PUBLIC
    "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR};${hilda_generated};${PROJECT_BINARY_DIR}/granular/generated>"
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/hilda>)
target_link_libraries(hilda_library PUBLIC
    Eigen3::Eigen KLU::KLU SPQR::SPQR fmt::fmt
    PRIVATE "$<BUILD_INTERFACE:Threads::Threads;${CMAKE_DL_LIBS}>")
if(NOT HILDA_SANITIZE)
    # No undefined symbols. This also verifies that these rooms do not use GSL.
    target_link_options(hilda_library PRIVATE LINKER:--no-undefined)
endif()
if(HILDA_NATIVE)
    # The alignment of Eigen types depends on the instruction set: the library and its user need the same
    # flag.
    target_compile_options(hilda_library INTERFACE -march=native)
endif()

install(TARGETS hilda_library EXPORT hilda_targets LIBRARY COMPONENT libraries NAMELINK_COMPONENT dev)

# hilda_component(<room> OBJECTS <objects>... [PUBLIC <target>...] [PRIVATE <target>...]): libhilda_<room>.so, the component
# <room> of the package. It may be left out of a build: the package then gives the reason.
function(hilda_component room)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "OBJECTS;PUBLIC;PRIVATE")
    add_library(hilda_${room}_library SHARED ${arg_OBJECTS})
    set_target_properties(hilda_${room}_library PROPERTIES
        OUTPUT_NAME hilda_${room}
        EXPORT_NAME ${room}
        VERSION ${PROJECT_VERSION}
        SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
        BUILD_WITH_INSTALL_RPATH ON # all libraries lie in one folder, in the build as well
        INSTALL_RPATH "$ORIGIN")
    target_compile_features(hilda_${room}_library PUBLIC cxx_std_20)
    # The libraries in PRIVATE are not needed to compile against this one: the package does not search them.
    target_link_libraries(hilda_${room}_library PUBLIC hilda_library ${arg_PUBLIC} PRIVATE "$<BUILD_INTERFACE:${arg_PRIVATE}>")
    # Also a library whose functions are not called has entries that register themselves.
    target_link_options(hilda_${room}_library PUBLIC LINKER:--no-as-needed)
    if(NOT HILDA_SANITIZE)
        target_link_options(hilda_${room}_library PRIVATE LINKER:--no-undefined)
    endif()
    install(TARGETS hilda_${room}_library EXPORT hilda_${room}_targets OPTIONAL LIBRARY COMPONENT libraries NAMELINK_COMPONENT dev)
    install(EXPORT hilda_${room}_targets FILE hilda-${room}.cmake NAMESPACE hilda:: DESTINATION "${hilda_package_dir}")
endfunction()
hilda_component(reference
    OBJECTS $<TARGET_OBJECTS:reference_objects>
    PRIVATE GSL::gsl SUNDIALS::ida SUNDIALS::nvecserial SUNDIALS::sunmatrixsparse SUNDIALS::sunlinsolklu)
if(TARGET granular_objects)
    hilda_component(granular
        OBJECTS $<TARGET_OBJECTS:granular_objects> $<TARGET_OBJECTS:granular_no_gpu>
        PRIVATE OpenMP::OpenMP_CXX hilda_granular_loops)
    hilda_component(studies
        OBJECTS "$<FILTER:$<TARGET_OBJECTS:run_objects>,INCLUDE,${hilda_fits}>" $<TARGET_OBJECTS:granular_run_objects>
            $<TARGET_OBJECTS:studies_objects> $<TARGET_OBJECTS:granular_study_objects>
        PUBLIC hilda_reference_library hilda_granular_library
        PRIVATE Threads::Threads OpenMP::OpenMP_CXX ${CMAKE_DL_LIBS})
endif()

install(TARGETS hilda_program RUNTIME COMPONENT programs)
if(TARGET hilda_granular_program)
    install(TARGETS hilda_granular_program RUNTIME COMPONENT programs)
    # Man pages and completion, from the help texts
    if(HILDA_PYTHON AND NOT CMAKE_CROSSCOMPILING)
        set(commands "${PROJECT_BINARY_DIR}/commands")
        set(command_files "${commands}/hilda.1" "${commands}/hilda-granular.1" "${commands}/hilda.bash")
        add_custom_command(OUTPUT ${command_files}
            COMMAND ${HILDA_PYTHON} "${PROJECT_SOURCE_DIR}/cmake/command_files.py"
                $<TARGET_FILE:hilda_program> $<TARGET_FILE:hilda_granular_program> "${commands}"
            DEPENDS hilda_program hilda_granular_program "${PROJECT_SOURCE_DIR}/cmake/command_files.py" VERBATIM)
        add_custom_target(hilda_command_files ALL DEPENDS ${command_files})
        install(FILES "${commands}/hilda.1" "${commands}/hilda-granular.1" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1"
            COMPONENT programs OPTIONAL)
        foreach(program hilda hilda-granular)
            install(FILES "${commands}/hilda.bash" DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions"
                RENAME ${program} COMPONENT programs OPTIONAL)
        endforeach()
    endif()
endif()
foreach(module hilda_grains hilda_mpi hilda_hdf5 hilda_urdf hilda_mjcf)
    if(TARGET ${module})
        install(TARGETS ${module} LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}/hilda" COMPONENT programs)
    endif()
endforeach()

# The public headers. Those of studies are what a plug-in needs (hildaPlugin.cmake), and a program with studies of its own.
function(hilda_install_headers)
    cmake_parse_arguments(PARSE_ARGV 0 arg "" "" "FOLDERS;FILES;EXCEPT")
    foreach(folder IN LISTS arg_FOLDERS)
        file(GLOB_RECURSE found CONFIGURE_DEPENDS RELATIVE "${PROJECT_SOURCE_DIR}" "${PROJECT_SOURCE_DIR}/${folder}/*.hpp")
        list(APPEND arg_FILES ${found})
    endforeach()
    list(REMOVE_ITEM arg_FILES ${arg_EXCEPT})
    foreach(file IN LISTS arg_FILES)
        get_filename_component(folder "${file}" DIRECTORY)
        install(FILES "${PROJECT_SOURCE_DIR}/${file}" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/hilda/${folder}")
    endforeach()
endfunction()
file(GLOB cosim_headers CONFIGURE_DEPENDS RELATIVE "${PROJECT_SOURCE_DIR}" "${PROJECT_SOURCE_DIR}/run/cosim/*.hpp")
hilda_install_headers(
    FOLDERS io lie dae contact reference run studies/framework studies/problems granular/force_models
    FILES granular/backend/any_of.hpp granular/backend/cube_root.hpp granular/backend/engine.hpp granular/backend/finite_state.hpp
        granular/backend/fixed_sum.hpp
        granular/backend/par.hpp granular/backend/real.hpp
        granular/clumps/clump_template.hpp granular/clumps/sphere_union.hpp
        granular/core/attached.hpp granular/core/boundary.hpp granular/core/boundary_blocks.hpp
        granular/core/clump.hpp granular/core/contact_loop.hpp granular/core/contact_point.hpp granular/core/integrator.hpp
        granular/core/material.hpp granular/core/neighbours/cells.hpp granular/core/neighbours/neighbours.hpp
        granular/core/orientation.hpp granular/core/pair_law.hpp granular/core/particles.hpp granular/core/removal.hpp
        granular/core/surfaces/meridian.hpp granular/core/surfaces/mesh_view.hpp granular/core/surfaces/meshes.hpp
        granular/core/surfaces/surfaces.hpp granular/core/surfaces/triangle_mesh.hpp granular/core/watch.hpp
        granular/mesh/mesh_file.hpp granular/mesh/mesh_shapes.hpp
        granular/world/boundary_drawing.hpp granular/world/double_world.hpp granular/world/output.hpp granular/world/watch.hpp granular/world/world.hpp
    # parts of the solvers, what includes headers of GSL, and co-simulation, which needs the cases of granular
    EXCEPT ${cosim_headers} lie/solver/columns.hpp lie/solver/condensed.hpp lie/solver/condensed_kernels.hpp lie/solver/elimination.hpp
        lie/solver/klu_saddle.hpp
        lie/solver/saddle_factors.hpp reference/solvers/gsl_errors.hpp reference/solvers/sundials.hpp)
install(FILES "${hilda_generated}/hilda/version.hpp" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/hilda/hilda")
install(FILES "${PROJECT_SOURCE_DIR}/cmake/hildaPlugin.cmake" "${PROJECT_SOURCE_DIR}/cmake/plugin_interface.cpp"
    DESTINATION "${hilda_package_dir}")
if(TARGET granular_objects)
    install(FILES "${PROJECT_BINARY_DIR}/granular/generated/granular/force_models.hpp"
        DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/hilda/granular")
    # For programs with granular laws of their own (granular/program.cmake): the objects of hilda-granular that do not depend on the
    # laws, and the source of the others.
    include("${PROJECT_SOURCE_DIR}/granular/laws.cmake")
    list(TRANSFORM granular_law_files REPLACE "^.*/([^/]*)[.]cpp$" "\\1" OUTPUT_VARIABLE law_objects)
    list(JOIN law_objects "|" law_objects)
    set(law_objects "/(${law_objects})[.]cpp[.]o$")
    add_library(hilda_granular_parts STATIC $<TARGET_OBJECTS:io_objects>
        "$<FILTER:$<TARGET_OBJECTS:granular_objects>,EXCLUDE,${law_objects}>"
        "$<FILTER:$<TARGET_OBJECTS:hilda_granular_program>,EXCLUDE,${law_objects}>")
    set_target_properties(hilda_granular_parts PROPERTIES LINKER_LANGUAGE CXX)
    install(TARGETS hilda_granular_parts OPTIONAL)
    foreach(room io granular)
        install(DIRECTORY "${PROJECT_SOURCE_DIR}/${room}" DESTINATION "${CMAKE_INSTALL_DATADIR}/hilda/source"
            FILES_MATCHING REGEX "[.](hpp|cuh?|cmake|cpp[.]in)$" PATTERN benchmarks EXCLUDE PATTERN cases EXCLUDE)
    endforeach()
    include("${PROJECT_SOURCE_DIR}/granular/loops.cmake")
    granular_can_dispatch(granular_dispatch)
    set(granular_source_files ${granular_law_files} ${granular_loop_files} backend/engine_no_gpu.cpp)
    list(REMOVE_DUPLICATES granular_source_files)
    foreach(file IN LISTS granular_source_files)
        get_filename_component(folder "${file}" DIRECTORY)
        install(FILES "${PROJECT_SOURCE_DIR}/granular/${file}" DESTINATION "${CMAKE_INSTALL_DATADIR}/hilda/source/granular/${folder}")
    endforeach()
    install(FILES "${hilda_generated}/hilda/version.hpp" DESTINATION "${CMAKE_INSTALL_DATADIR}/hilda/source/hilda")
endif()
install(FILES "${PROJECT_SOURCE_DIR}/dae/model.schema.json" "${PROJECT_SOURCE_DIR}/granular/case.schema.json"
    DESTINATION "${CMAKE_INSTALL_DATADIR}/hilda" COMPONENT programs OPTIONAL)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/studies/plots" DESTINATION "${CMAKE_INSTALL_DATADIR}/hilda" COMPONENT programs OPTIONAL
    FILES_MATCHING REGEX "[.](py|js|html)$")
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT programs)

set(hilda_source_dir "${CMAKE_INSTALL_DATADIR}/hilda/source")
configure_package_config_file(cmake/hildaConfig.cmake.in "${PROJECT_BINARY_DIR}/installed/hildaConfig.cmake"
    INSTALL_DESTINATION "${hilda_package_dir}" PATH_VARS CMAKE_INSTALL_LIBDIR hilda_source_dir)
# Before 1.0 a minor version may be incompatible.
write_basic_package_version_file("${PROJECT_BINARY_DIR}/installed/hildaConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(EXPORT hilda_targets FILE hildaTargets.cmake NAMESPACE hilda:: DESTINATION "${hilda_package_dir}")
install(
    FILES "${PROJECT_BINARY_DIR}/installed/hildaConfig.cmake" "${PROJECT_BINARY_DIR}/installed/hildaConfigVersion.cmake"
        "${PROJECT_SOURCE_DIR}/cmake/FindKLU.cmake" "${PROJECT_SOURCE_DIR}/cmake/FindSPQR.cmake"
    DESTINATION "${hilda_package_dir}")

# The same package for this build folder, without an installation: CMAKE_PREFIX_PATH=build/release
file(REMOVE "${PROJECT_BINARY_DIR}/hildaConfig.cmake") # of version 0.1, which find_package would find first
set(package "${PROJECT_BINARY_DIR}/lib/cmake/hilda")
function(hilda_package_of_build)
    set(CMAKE_INSTALL_LIBDIR .)
    set(hilda_source_dir "${PROJECT_SOURCE_DIR}")
    set(hilda_generated_dir "${hilda_generated}")
    configure_package_config_file(cmake/hildaConfig.cmake.in "${package}/hildaConfig.cmake"
        INSTALL_PREFIX "${PROJECT_BINARY_DIR}" INSTALL_DESTINATION "${package}" PATH_VARS CMAKE_INSTALL_LIBDIR hilda_source_dir)
endfunction()
hilda_package_of_build()
foreach(file "${PROJECT_BINARY_DIR}/installed/hildaConfigVersion.cmake" "${PROJECT_SOURCE_DIR}/cmake/FindKLU.cmake"
        "${PROJECT_SOURCE_DIR}/cmake/FindSPQR.cmake" "${PROJECT_SOURCE_DIR}/cmake/hildaPlugin.cmake"
        "${PROJECT_SOURCE_DIR}/cmake/plugin_interface.cpp")
    get_filename_component(name "${file}" NAME)
    configure_file("${file}" "${package}/${name}" COPYONLY)
endforeach()
export(EXPORT hilda_targets FILE "${package}/hildaTargets.cmake" NAMESPACE hilda::)
foreach(room reference granular studies)
    if(TARGET hilda_${room}_library)
        export(EXPORT hilda_${room}_targets FILE "${package}/hilda-${room}.cmake" NAMESPACE hilda::)
    endif()
endforeach()
