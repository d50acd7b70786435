// SPDX-License-Identifier: GPL-3.0-or-later
/// Pages that animate the result of a run in a browser (studies/plots/view.py).

#pragma once

#include <string>

namespace hilda::studies {

struct ViewOptions {
    std::string directory;  ///< of a run, a co-simulation or a granular run
    std::string output;     ///< the page; empty: view.html in the directory
    long frames = 1000;     ///< at most, of the rows of a trajectory or the frames of grains; at least 2
    bool serve = false;     ///< serve the page on 127.0.0.1 until the program is ended; it follows the run
    long port = 8000;       ///< of the server; 0: any free one
};

/// Writes the page, prints its name, and returns the exit code; or serves it, and returns only if the server
/// cannot be started. A model is read from model.json of the directory.
///
/// Throws io::InvalidInput if the directory has no result that can be drawn, or if `output` exists and is no
/// page; io::NotAvailable without Python, NumPy or three.js; io::IoError.
int view(const ViewOptions& options);

}  // namespace hilda::studies
