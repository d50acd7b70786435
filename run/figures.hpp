// SPDX-License-Identifier: GPL-3.0-or-later
/// Files of figures. The program draws them, with scripts in Python: see studies/program/plot.hpp.

#pragma once

#include <functional>
#include <string>
#include <vector>

namespace hilda::run {

/// Formats of figures: those that matplotlib writes without further programs
const std::vector<std::string>& figure_formats();

/// Draws the results in a directory with a script, for example "convergence.py", in these formats (none:
/// png). Returns the names of the files, none if nothing could be drawn.
using DrawFigures = std::function<std::vector<std::string>(
    const std::string& script, const std::string& directory, const std::vector<std::string>& formats)>;

/// Removes the figure with this name, NAME.png, in all formats.
void remove_figure(const std::string& directory, const std::string& name);
/// The names of the figure NAME.png in these formats, of those that exist in the directory. Without formats:
/// png
std::vector<std::string> existing_figures(const std::string& directory, const std::string& name,
                                          const std::vector<std::string>& formats);

}  // namespace hilda::run
