# SPDX-License-Identifier: GPL-3.0-or-later
# embed_text(FILE NAMESPACE NAME SOURCE): writes the C++ file SOURCE, which defines `const char NAME[]` with the text
# of a file, so that a program has the text without the source tree.
set(embed_text_template "${CMAKE_CURRENT_LIST_DIR}/embedded_text.cpp.in")
function(embed_text embedded_file embedded_namespace embedded_name source)
    file(READ "${embedded_file}" embedded_text)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${embedded_file}")
    configure_file("${embed_text_template}" "${source}" @ONLY)
endfunction()
