// SPDX-License-Identifier: GPL-3.0-or-later
/// What a plug-in and the program must have in common: version, compiler and alignment.

#pragma once

#include <Eigen/Core>

#include <hilda/version.hpp>

#define HILDA_TEXT_OF(value) #value
#define HILDA_TEXT_OF_VALUE(macro) HILDA_TEXT_OF(macro)

/// "0.1.0 (7734a36), compiler 12.2.0, alignment 16". The alignment of Eigen types depends on the instruction
/// set (-march).
#define HILDA_PLUGIN_INTERFACE \
    HILDA_VERSION_TEXT ", compiler " __VERSION__ ", alignment " HILDA_TEXT_OF_VALUE(EIGEN_MAX_ALIGN_BYTES)

/// Begins the interface of a plug-in in the bytes of its file.
#define HILDA_PLUGIN_MARKER "hilda plug-in interface: "
