// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run_study.hpp"

#include "studies/arguments.hpp"
#include "studies/output.hpp"

#include <unistd.h>

namespace hilda::studies {

namespace {

const Study& find(const std::string& kind)
{
    std::vector<std::string> known;
    for (const Study& study : studies()) {
        if (study.kind == kind) return study;
        known.push_back(study.kind);
    }
    throw UsageError("study: unknown study" + with_nearest(kind, known) + " (hilda study lists them)");
}

}  // namespace

int run_study(const std::string& kind, StudyOptions options, bool force)
{
    const Study& study = find(kind);
    if (options.output.empty() && !options.json) options.output = "out/" + kind;
    if (!options.output.empty()) {
        if (!is_vacant(options.output) && !force)
            throw UsageError(options.output + ": is not empty; --force overwrites");
        make_directory(options.output);
    }
    try {
        return study.run(options);
    } catch (...) {
        if (!options.output.empty())
            rmdir(options.output.c_str());  // leaves it alone when there is something in it
        throw;
    }
}

}  // namespace hilda::studies
