// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/collect.hpp"

#include "io/files.hpp"
#include "io/program.hpp"
#include "run/provenance.hpp"
#include "studies/program/arguments.hpp"
#include "studies/program/command_options.hpp"
#include "studies/program/plot.hpp"
#include "studies/program/run_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <sstream>

namespace hilda::studies {

namespace {

namespace fs = std::filesystem;

bool is_file(const std::string& name)
{
    std::error_code error;  // of names that the file system does not accept
    return fs::is_regular_file(name, error);
}

std::string entry(const run::JobRecords& records, const std::string& name)
{
    const auto at = records.identity.find(name);
    return at == records.identity.end() ? "" : at->second;
}

run::JobRecords read_shard(const std::string& directory)
{
    const std::string file = run::FinishedJobs::shard_file(directory),
                      part = run::FinishedJobs::part_file(directory);
    if (is_file(file)) {
        run::JobRecords records = run::read_job_records(file);
        if (entry(records, "--shard").empty() || records.command.empty())
            throw io::IoError(file + ": is not the file of a shard");
        return records;
    }
    if (!is_file(part))
        throw io::UsageError("collect: " + directory + ": is not the output of hilda study --shard");
    const std::string shard = entry(run::read_job_records(part), "--shard");
    throw io::UsageError(
        "collect: " + directory +
        (shard.empty() ? ": is an interrupted study; its command with --resume continues it"
                       : ": shard " + shard + " has not ended; its command with --resume continues it"));
}

std::string one_line(const std::string& value)
{
    std::string line;
    for (const char c : value) line += c == '\n' ? std::string(", ") : std::string(1, c);
    return value.empty() ? "the default" : "'" + line + "'";
}

/// Refuses shards of two studies, of other options, other models or another program.
void require_same(const run::JobRecords& a, const run::JobRecords& b)
{
    std::map<std::string, std::string> all = a.identity;
    all.insert(b.identity.begin(), b.identity.end());
    for (const auto& [name, unused] : all)
        if (name != "--shard" && entry(a, name) != entry(b, name))
            throw io::UsageError(fmt::format("collect: the shards differ in {}: {} in {}, {} in {}", name,
                                             one_line(entry(a, name)), a.file, one_line(entry(b, name)),
                                             b.file));
}

run::Shard shard_of(const run::JobRecords& records)
{
    run::Shard shard;
    char slash = 0;
    std::istringstream text(entry(records, "--shard"));
    if (!(text >> shard.index >> slash >> shard.count) || shard.index < 1 || shard.index > shard.count)
        throw io::IoError(records.file + ": is not the file of a shard");
    return shard;
}

/// Copies what runs have written beside their results. Files of `to` itself, such as study.csv, remain: a
/// shard has none of them, but its folder may have those of an earlier study.
void copy_other_files(const std::string& from, const std::string& to)
{
    for (const auto& item : fs::directory_iterator(from)) {
        const fs::path target = to / item.path().filename();
        if (item.is_directory())
            fs::copy(item.path(), target, fs::copy_options::recursive | fs::copy_options::overwrite_existing);
        else if (item.path().filename() != "study.shard")
            fs::copy(item.path(), target, fs::copy_options::skip_existing);
    }
}

/// Refuses an output directory that is a shard, or in one.
void refuse_output_in_shard(const std::string& output, const std::vector<std::string>& directories)
{
    const fs::path to = fs::weakly_canonical(output);
    for (const std::string& directory : directories) {
        const fs::path of = fs::weakly_canonical(directory);
        if (std::mismatch(of.begin(), of.end(), to.begin(), to.end()).first == of.end())
            throw io::UsageError("collect: --output: must not be the folder of a shard or in one, got " +
                                 output);
    }
}

}  // namespace

void add_collect_options(CLI::App& c, CollectOptions& o)
{
    c.add_option("DIR", o.directories, "output directories of all shards of a study")
        ->required()
        ->type_name("");
    add_output(c, "--force", "out/KIND", o.study.options.output);
    c.add_flag("--force", o.study.options.force, "overwrite an output directory that is not empty");
    values(c, "--expect", "KEY=VALUE[+-TOL]",
           "expected value of a result; exit code 6 if the result differs by more than TOL; repeatable",
           append_one(o.study.options.expect, expectation));
    add_no_plot(c, "draw no figures", o.study.plot);
    add_figure_format(c, o.study.figure_formats);
    c.add_flag("--latex", o.study.latex, "write study.tex as well: the tables of the text for LaTeX");
    c.add_flag("--quiet", o.study.options.quiet, "print no result and no warnings");
    c.add_flag("--json", o.study.json, "print the result as JSON on stdout");
}

run::JobRecords read_shards(const std::vector<std::string>& directories)
{
    std::map<long, run::JobRecords> by_index;
    long count = 0;
    for (const std::string& directory : directories) {
        run::JobRecords records = read_shard(directory);
        const run::Shard shard = shard_of(records);
        if (by_index.empty()) {
            count = shard.count;
            if (const std::string version = entry(records, "version of the program");
                version != run::version_line())
                throw io::UsageError("collect: " + records.file + " is of another version of the program, " +
                                     version + "; this one is " + run::version_line());
        } else {
            const run::JobRecords& first = by_index.begin()->second;
            require_same(first, records);
            if (shard.count != count)
                throw io::UsageError(
                    fmt::format("collect: the study was divided in two ways: {} has shard {}, {} "
                                "has shard {}",
                                first.file, entry(first, "--shard"), records.file, shard.text()));
        }
        if (const auto at = by_index.find(shard.index); at != by_index.end())
            throw io::UsageError(fmt::format("collect: shard {} is there twice: {} and {}", shard.text(),
                                             at->second.file, records.file));
        by_index.emplace(shard.index, std::move(records));
    }
    std::vector<std::string> missing;
    for (long k = 1; k <= count; ++k)
        if (!by_index.contains(k)) missing.push_back(fmt::format("{}/{}", k, count));
    constexpr size_t most_named = 10;
    if (const size_t n = missing.size(); n > 0) {
        if (n > most_named) {
            missing.resize(most_named);
            missing.push_back(fmt::format("... ({} in all)", n));
        }
        throw io::UsageError(fmt::format("collect: shards are missing: {}", fmt::join(missing, ", ")));
    }
    run::JobRecords all = std::move(by_index.begin()->second);
    for (auto& [index, records] : by_index) all.results.merge(records.results);
    all.identity.erase("--shard");
    return all;
}

std::vector<std::string> words_of(const run::JobRecords& shards)
{
    std::vector<std::string> words;
    std::istringstream in(shards.command);
    for (std::string word; std::getline(in, word, '\0');) words.push_back(word);
    return words;
}

int collect(const CollectOptions& collected, const run::JobRecords& shards, const std::string& kind,
            StudyArguments arguments)
{
    const StudyArguments& of = collected.study;
    arguments.plot = of.plot;
    arguments.figure_formats = of.figure_formats;
    arguments.draw = draw_figures;
    arguments.latex = of.latex;
    arguments.json = of.json;
    StudyOptions& options = arguments.options;
    options.shard = {};
    options.output = of.options.output;
    options.force = of.options.force;
    options.resume = false;
    options.quiet = of.options.quiet;
    options.expect.insert(options.expect.end(), of.options.expect.begin(), of.options.expect.end());
    const std::string to = options.output.empty() && !arguments.json ? "out/" + kind : options.output;
    if (!to.empty()) refuse_output_in_shard(to, collected.directories);
    const int code = run_collected(kind, arguments, shards);
    if (!to.empty())
        for (const std::string& directory : collected.directories) copy_other_files(directory, to);
    return code;
}

}  // namespace hilda::studies
