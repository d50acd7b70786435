// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/running/earlier_run.hpp"

#include "granular/case/continued_case.hpp"
#include "io/archive.hpp"
#include "io/error.hpp"
#include "io/files.hpp"
#include "io/message.hpp"

#include <cmath>
#include <cstdio>
#include <filesystem>

namespace hilda::granular {

namespace {

constexpr std::size_t most_of_summary = std::size_t{1} << 24, most_of_case = std::size_t{1} << 28;

/// Text of summary.json of a directory
std::string summary_of(const std::string& directory)
{
    return io::read_file(directory + "/summary.json", most_of_summary);
}

bool exists(const std::string& file)
{
    std::error_code error;
    return std::filesystem::exists(file, error);
}

/// Whether the run in a directory has reached its end, according to its summary.json
bool is_complete(const std::string& directory)
{
    const std::string file = directory + "/summary.json";
    if (io::CheckpointFiles(directory).exist() || !exists(file)) return false;
    try {
        const io::JsonSource summary(summary_of(directory), file, most_of_summary);
        const io::Json::Member* found = summary.root.member("status");
        return found != nullptr && found->value.string() != nullptr && *found->value.string() == "ok";
    } catch (const io::InvalidInput&) {
        return false;
    }
}

}  // namespace

std::optional<io::JsonSource> earlier_case(const std::string& directory)
{
    const std::string file = directory + "/case.json";
    if (!exists(file)) return {};
    return io::JsonSource(io::read_file(file, most_of_case), file);
}

Continuation read_run(const RunOptions& o, const std::string& text, const Environment& environment)
{
    const std::optional<io::JsonSource> earlier =
        o.resume ? earlier_case(o.output) : std::optional<io::JsonSource>();
    if (!earlier) return new_run(text, o.file, environment);
    Environment continued = environment;
    continued.continues = &*earlier;
    return continued_run(text, o.file, continued, o.output, *earlier);
}

EarlierRun earlier_run(const RunOptions& o, const Case& c)
{
    const std::optional<io::JsonSource> earlier = earlier_case(o.output);
    if (!earlier) return {};
    const double end = end_of(*earlier);
    const EarlierRun run = {.is_complete = is_complete(o.output), .end = std::lround(end / c.h)};
    const long new_end = std::lround(c.end / c.h);
    if (!run.is_complete || run.end == new_end) return run;
    // a run with stages may have ended earlier, which its last checkpoint states
    if (new_end < run.end && c.stages == nullptr) refuse_end(o, c, end);
    if (!exists(o.output + "/checkpoint.end"))
        throw io::UsageError("granular: " + o.output +
                             ": its run has ended without checkpoint.end; --force starts it again");
    return run;
}

void refuse_end(const RunOptions& o, const Case& c, double reached)
{
    throw io::UsageError(io::formatted(
        "granular: --end must be after t = %.12g s, which the run in %s has reached, got %.12g; "
        "--force starts it again",
        reached, o.output.c_str(), c.end));
}

void refuse_end_after_stages(const RunOptions& o, double reached)
{
    throw io::UsageError(io::formatted(
        "granular: --end has no effect on the run in %s: its last stage has ended at t = %.12g s, and "
        "the run with it; a case with a longer or another last stage is a new run",
        o.output.c_str(), reached));
}

int report_complete(const RunOptions& o, const Case& c)
{
    if (!o.quiet)
        io::message(
            io::formatted("hilda: %s: the run is complete already, with the end %g s; --end with a "
                          "later time extends it\n",
                          o.output.c_str(), c.end));
    if (o.json) std::fputs(summary_of(o.output).c_str(), stdout);
    return io::exit_code::done;
}

}  // namespace hilda::granular
