// SPDX-License-Identifier: GPL-3.0-or-later
/// Studies that the tests divide into shards.

#pragma once

#include <string>
#include <vector>

namespace hilda::tests {

/// The coarse grid of the study of the incline
inline const std::vector<std::string> incline = {"study",   "incline-sweep", "--grid",   "coarse",
                                                 "--steps", "1e-3",          "--no-plot"};

/// Five runs of the model swing.json with different masses
inline const std::vector<std::string> swing = {
    "study", "sweep", "swing.json", "--sweep", "/bodies/0/mass=1:5:5", "--keep", "--no-plot"};

}  // namespace hilda::tests
