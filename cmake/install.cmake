# SPDX-License-Identifier: GPL-3.0-or-later
# Installs libhilda.so (the rooms io, lie, dae and contact), its headers, the programs, and a package for
# find_package(hilda CONFIG). The library does not use GSL.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(hilda_package_dir "${CMAKE_INSTALL_LIBDIR}/cmake/hilda")

# The target is not named `hilda`, the name of the program in the build folder.
add_library(hilda_library SHARED
    $<TARGET_OBJECTS:io_objects> $<TARGET_OBJECTS:lie_objects> $<TARGET_OBJECTS:dae_objects> $<TARGET_OBJECTS:contact_objects>)
add_library(hilda::hilda ALIAS hilda_library)
set_target_properties(hilda_library PROPERTIES
    OUTPUT_NAME hilda
    EXPORT_NAME hilda
    VERSION ${PROJECT_VERSION}
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
target_compile_features(hilda_library PUBLIC cxx_std_20)
target_include_directories(hilda_library PUBLIC
    "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>" $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/hilda>)
target_link_libraries(hilda_library PUBLIC
    Eigen3::Eigen KLU::KLU SPQR::SPQR fmt::fmt)
if(NOT HILDA_SANITIZE)
    # No undefined symbols. This also verifies that these rooms do not use GSL.
    target_link_options(hilda_library PRIVATE LINKER:--no-undefined)
endif()
if(HILDA_NATIVE)
    # The alignment of Eigen types depends on the instruction set: the library and its user need the same
    # flag.
    target_compile_options(hilda_library INTERFACE -march=native)
endif()

install(TARGETS hilda_library EXPORT hilda_targets)
if(TARGET hilda_program)
    install(TARGETS hilda_program hilda_granular_program)
endif()
if(TARGET hilda_hdf5)
    install(TARGETS hilda_hdf5 LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}/hilda")
endif()
# What a plug-in needs (hildaPlugin.cmake): the headers of studies, and the interface of this build.
foreach(room io lie dae contact studies)
    install(DIRECTORY "${PROJECT_SOURCE_DIR}/${room}" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/hilda"
        FILES_MATCHING PATTERN "*.hpp" PATTERN "hdf5_storage.hpp" EXCLUDE)
endforeach()
install(FILES "${hilda_generated}/hilda/version.hpp" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/hilda/hilda")
install(FILES "${PROJECT_SOURCE_DIR}/cmake/hildaPlugin.cmake" "${PROJECT_SOURCE_DIR}/cmake/plugin_interface.cpp"
    DESTINATION "${hilda_package_dir}")
install(FILES "${PROJECT_SOURCE_DIR}/dae/model.schema.json" "${PROJECT_SOURCE_DIR}/granular/case.schema.json"
    DESTINATION "${CMAKE_INSTALL_DATADIR}/hilda" OPTIONAL)
install(DIRECTORY "${PROJECT_SOURCE_DIR}/studies/plots" DESTINATION "${CMAKE_INSTALL_DATADIR}/hilda" OPTIONAL
    FILES_MATCHING PATTERN "*.py")
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}")

configure_package_config_file(cmake/hildaConfig.cmake.in "${PROJECT_BINARY_DIR}/hildaConfig.cmake"
    INSTALL_DESTINATION "${hilda_package_dir}")
# Before 1.0 a minor version may be incompatible.
write_basic_package_version_file("${PROJECT_BINARY_DIR}/hildaConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(EXPORT hilda_targets FILE hildaTargets.cmake NAMESPACE hilda:: DESTINATION "${hilda_package_dir}")
install(
    FILES "${PROJECT_BINARY_DIR}/hildaConfig.cmake" "${PROJECT_BINARY_DIR}/hildaConfigVersion.cmake"
        "${PROJECT_SOURCE_DIR}/cmake/FindKLU.cmake" "${PROJECT_SOURCE_DIR}/cmake/FindSPQR.cmake"
    DESTINATION "${hilda_package_dir}")
