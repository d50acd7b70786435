// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/earlier_run.hpp"

#include "dae/model_file.hpp"
#include "io/archive.hpp"
#include "io/files.hpp"
#include "io/json_source.hpp"
#include "io/option_values.hpp"
#include "lie/schemes.hpp"
#include "run/recording/setting_options.hpp"
#include "run/tables/run_table.hpp"

#include <fmt/format.h>

#include <filesystem>

namespace hilda::run {

namespace {

namespace fs = std::filesystem;

bool exists(const std::string& file)
{
    std::error_code error;
    return fs::exists(file, error);
}

}  // namespace

io::Json earlier_summary(const std::string& directory)
{
    const std::string file = directory + "/summary.json";
    return io::JsonSource(io::read_file(file, io::JsonSource::max_bytes), file, io::JsonSource::max_bytes)
        .root;
}

EarlierRun::EarlierRun(std::string directory)
    : has_ended(exists(directory + "/summary.json") && !io::CheckpointFiles(directory).exist()),
      directory(std::move(directory))
{}

void EarlierRun::read(const std::string& bytes, const std::string& of_file)
{
    Checkpoint checkpoint = from_bytes(bytes, of_file);
    if (checkpoint.settings.count("--interval") == 0)
        throw io::IoError(of_file + ": the checkpoint is damaged: it has no --interval");
    from = std::move(checkpoint);
    file = of_file;
}

void EarlierRun::require_checkpoint() const
{
    if (!from && has_ended)
        throw RunHasEnded(directory + ": its run has ended without a checkpoint; --force starts it again");
}

RunSettings EarlierRun::settings(const RunIdentity& of) const
{
    const RunOptions& o = of.options;
    RunSettings all = o.outputs;
    if (const auto format = all.find(format_option); format != all.end() && format->second == default_format)
        all.erase(format);
    const std::string& text = of.description.text;
    all["model"] = fmt::format("{:016x}", io::checksum(text.data(), text.size()));
    all["--integrator"] = of.scheme.name;
    all.merge(given_settings(o.settings, of.scheme));
    if (!of.scheme.adaptive) all["--step"] = io::shortest(of.grid.h);
    // Rows are counted in steps: with another step the rows of the interrupted run would have another
    // interval.
    all["--interval"] = from && !o.interval ? from->settings.at("--interval")
                                            : io::shortest(static_cast<double>(of.grid.interval) * of.grid.h);
    if (o.fix_initial) all["--fix-initial"] = "";
    if (!o.plugins.empty()) all["--load"] = fmt::format("{}", fmt::join(o.plugins, " --load "));
    return all;
}

void EarlierRun::check_continues(const RunIdentity& by, const RunSettings& of_run) const
{
    RunSettings earlier = from->settings;
    for (const SettingOption& option : setting_options())  // earlier programs recorded them
        if (!by.scheme.uses_option(option.name)) earlier.erase(option.name);
    earlier = with_defaults(std::move(earlier));
    const RunSettings now = with_defaults(of_run);
    if (earlier != now) {
        const std::string model = directory + "/model.json";
        throw io::UsageError(fmt::format(
            "{}: the checkpoint belongs to another run: {}; --force starts it again", directory,
            difference(earlier, now, exists(model) ? io::read_file(model, io::JsonSource::max_bytes) : "",
                       by.model_text)));
    }
    check_fits(*from, *by.description.model, by.description.x, file);
    const long steps = by.grid.steps;
    const bool same_end = lie::TimeGrid::over(from->end, by.grid.h).steps == steps;
    if (has_ended && same_end)
        throw RunIsComplete(
            fmt::format("{}: its run is complete, with the end {} s; --end with a later time extends it, "
                        "--force starts it again",
                        directory, from->end));
    if (steps < from->number || (steps == from->number && !same_end))
        throw io::UsageError(
            fmt::format("run: --end must be after t = {} s, which the run in {} has reached, "
                        "got {}; --force starts it again",
                        from->node.t, directory, by.end));
}

}  // namespace hilda::run
