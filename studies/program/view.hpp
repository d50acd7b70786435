// SPDX-License-Identifier: GPL-3.0-or-later
/// Pages that animate the result of a run in a browser, and videos of them (studies/plots/view.py).

#pragma once

#include <string>

namespace hilda::studies {

struct ViewOptions {
    std::string directory;  ///< of a run, a co-simulation or a granular run
    std::string output;     ///< the page or video; empty: view.html or view.mp4 in the directory
    long frames = 1000;     ///< at most, of the rows of a trajectory or the frames of grains; at least 2
    bool video = false;     ///< write a video instead of the page
    double seconds = 0;     ///< duration of the video [s]; 0: that of the run if from 3 to 30 s, otherwise 10
    bool serve = false;     ///< serve the page on 127.0.0.1 until the program is ended; it follows the run
    long port = 8000;       ///< of the server; 0: any free one
};

/// Writes the page or the video and prints its name, or serves the page. A model is read from model.json of
/// the directory. The script replaces this program.
///
/// Throws io::InvalidInput if the directory has no result that can be drawn, or if `output` exists and is no
/// page or no video; io::UsageError for options that exclude each other; io::NotAvailable without Python;
/// io::IoError. The script ends with the exit codes of these exceptions.
[[noreturn]] void view(const ViewOptions& options);

}  // namespace hilda::studies
