// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/program/earlier_run.hpp"

#include "granular/case/continued_case.hpp"
#include "io/archive.hpp"
#include "io/error.hpp"
#include "io/files.hpp"
#include "io/message.hpp"

#include <algorithm>
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

bool end_is_given(const Options& o)
{
    return std::any_of(o.settings.begin(), o.settings.end(),
                       [](const Setting& s) { return s.change.starts_with("/end="); });
}

/// "; POINTER was A and is B now" for the first entry that differs; empty if there is none
std::string difference(const io::Json& before, const io::Json& now, const std::string& pointer)
{
    const auto text = [](const io::Json* value) {
        std::string all = value == nullptr ? "missing" : io::written(*value);
        constexpr std::size_t most = 60;
        return all.size() > most || all.find('\n') != std::string::npos ? std::string("another value") : all;
    };
    const auto differs = [&](const io::Json* a, const io::Json* b) {
        return "; " + (pointer.empty() ? "/" : pointer) + " was " + text(a) + " and is " + text(b) + " now";
    };
    if (before.members() != nullptr && now.members() != nullptr) {
        for (const io::Json::Member& m : *before.members()) {
            const io::Json::Member* const other = now.member(m.key);
            const std::string at = pointer + '/' + m.key;
            if (other == nullptr) return "; " + at + " was " + text(&m.value) + " and is missing now";
            if (std::string found = difference(m.value, other->value, at); !found.empty()) return found;
        }
        for (const io::Json::Member& m : *now.members())
            if (before.member(m.key) == nullptr)
                return "; " + pointer + '/' + m.key + " was missing and is " + text(&m.value) + " now";
        return "";
    }
    if (before.list() != nullptr && now.list() != nullptr && before.size() == now.size()) {
        for (std::size_t k = 0; k < before.size(); ++k)
            if (std::string found = difference(before.at(k), now.at(k), pointer + '/' + std::to_string(k));
                !found.empty())
                return found;
        return "";
    }
    return io::written(before) == io::written(now) ? "" : differs(&before, &now);
}

std::string difference(const io::JsonSource& before, const io::JsonSource& now)
{
    return difference(io::JsonSource(identity(before), "", most_of_case).root,
                      io::JsonSource(identity(now), "", most_of_case).root, "");
}

}  // namespace

std::optional<io::JsonSource> earlier_case(const std::string& directory)
{
    const std::string file = directory + "/case.json";
    if (!exists(file)) return {};
    return io::JsonSource(io::read_file(file, most_of_case), file);
}

EarlierRun earlier_run(const Options& o, const Case& c)
{
    const std::optional<io::JsonSource> earlier = earlier_case(o.output);
    if (!earlier) return {};
    const double end = end_of(*earlier);
    const EarlierRun run = {.is_complete = is_complete(o.output), .end = std::lround(end / c.h)};
    const long new_end = std::lround(c.end / c.h);
    const bool is_other = identity(*earlier) != identity(c.source);
    if (is_other || (run.end != new_end && !end_is_given(o)))
        throw io::IoError(
            "--resume: " + o.output +
            "/case.json: is another case, or this case with other options; --force overwrites it" +
            (is_other ? difference(*earlier, c.source)
                      : "; its end is " + io::shortest(end) + " s, --end continues it to another"));
    if (!run.is_complete || run.end == new_end) return run;
    if (new_end < run.end) refuse_end(o, c, end);
    if (!exists(o.output + "/checkpoint.end"))
        throw io::UsageError("granular: " + o.output +
                             ": its run has ended without checkpoint.end; --force starts it again");
    return run;
}

void refuse_end(const Options& o, const Case& c, double reached)
{
    throw io::UsageError(io::formatted(
        "granular: --end must be after t = %.12g s, which the run in %s has reached, got %.12g; "
        "--force starts it again",
        reached, o.output.c_str(), c.end));
}

int report_complete(const Options& o, const Case& c)
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
