# SPDX-License-Identifier: GPL-3.0-or-later
# Writes the git state into version.hpp at every build. configure_file does not touch an unchanged file, so
# nothing is recompiled.
set(hilda_git "")
# An unpacked release inside the checkout of another project has no git state.
if(git AND EXISTS "${source}/.git")
    execute_process(
        COMMAND "${git}" --no-optional-locks describe --tags --always --dirty
        WORKING_DIRECTORY "${source}"
        OUTPUT_VARIABLE hilda_git OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
endif()
if(hilda_git STREQUAL "")
    set(hilda_git unknown)
endif()
configure_file("${input}" "${output}" @ONLY)
