// SPDX-License-Identifier: GPL-3.0-or-later
/// The command hilda reproduce: the studies of the dissertation, and one page with their results.

#pragma once

#include <string>
#include <vector>

namespace hilda::studies {

struct ReproduceOptions {
    std::vector<int> chapters;  ///< empty: all
    bool quick = false, full = false;
    std::string output = "out/reproduce";
    bool resume = false, force = false, plot = true, quiet = false;
    int jobs = 0;  ///< 0: the number of cores
};

/// Runs the studies of reproductions() in processes of their own, each in OUTPUT/NAME, and writes
/// OUTPUT/index.html after each of them. Studies that measure time run alone. Finished studies are listed in
/// OUTPUT/reproduce.json; --resume does not run them again. A signal ends the studies, which keep their
/// finished runs.
///
/// Returns the exit code of the first study that ended with an error; otherwise 6 if a criterion failed.
/// io::UsageError before the first study starts.
int reproduce(const ReproduceOptions& options);

}  // namespace hilda::studies
