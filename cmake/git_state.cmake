# SPDX-License-Identifier: GPL-3.0-or-later
# Runs at every build: fills the git state into version.hpp. configure_file leaves an unchanged file untouched, so
# nothing is compiled again.
set(hilda_git "")
# Only our own repository counts: an unpacked release inside some other checkout has no git state.
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
