// SPDX-License-Identifier: GPL-3.0-or-later
/// A plug-in that registers a scheme under the name of an existing one: it throws while it is loaded.

#include "lie/schemes.hpp"

const bool registered =
    hilda::io::Registry<hilda::lie::Scheme>::add({.name = "rA-half-1", .description = "a copy", .order = 1});
