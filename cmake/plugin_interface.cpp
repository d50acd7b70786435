// SPDX-License-Identifier: GPL-3.0-or-later
// A part of each plug-in (hilda_add_plugin): the interface that it was built for. `hilda --load` reads this
// text in the file before it loads the plug-in.
#include "run/plugin_interface.hpp"

extern "C" [[gnu::used]] const char hilda_plugin_interface[] = HILDA_PLUGIN_MARKER HILDA_PLUGIN_INTERFACE;
