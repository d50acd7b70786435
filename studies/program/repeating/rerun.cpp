// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/repeating/rerun.hpp"

#include "io/error.hpp"
#include "io/files.hpp"
#include "io/json_source.hpp"
#include "io/provenance.hpp"
#include "run/cosim/granular_program.hpp"
#include "run/provenance.hpp"
#include "studies/program/repeating/compare_results.hpp"

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <iostream>
#include <optional>

extern char** environ;

namespace hilda::studies {

namespace fs = std::filesystem;

namespace {

struct Record {
    std::string file, command, version;
    std::vector<std::pair<std::string, std::string>> inputs = {};  ///< files with their checksums
};

/// The files that a result was computed from
std::vector<std::pair<std::string, std::string>> inputs_of(const io::Json& provenance)
{
    std::vector<std::pair<std::string, std::string>> all;
    const io::Json::Member* const inputs = provenance.member("inputs");
    for (size_t k = 0; inputs != nullptr && k < inputs->value.size(); ++k) {
        const io::Json::Member *const file = inputs->value.at(k).member("file"), *const sum =
                                                                                     inputs->value.at(k)
                                                                                         .member("checksum");
        if (file != nullptr && sum != nullptr && file->value.string() != nullptr &&
            sum->value.string() != nullptr)
            all.emplace_back(*file->value.string(), *sum->value.string());
    }
    return all;
}

/// The record in a directory; nothing without a summary.json, study.json or fit.json
std::optional<Record> record_in(const fs::path& directory)
{
    for (const char* name : {"summary.json", "study.json", "fit.json"}) {
        const std::string file = directory / name;
        std::error_code error;
        if (!fs::is_regular_file(file, error)) continue;
        const io::JsonSource source(io::read_file(file, io::JsonSource::max_bytes), file,
                                    io::JsonSource::max_bytes);
        const io::Json::Member* provenance = source.root.member("provenance");
        const auto text = [&](const char* key) -> std::string {
            const io::Json::Member* member = provenance == nullptr ? nullptr : provenance->value.member(key);
            return member == nullptr || member->value.string() == nullptr ? "" : *member->value.string();
        };
        if (text("command_line").empty())
            throw io::InvalidInput(file + ": has no command line in its provenance");
        return Record{file, text("command_line"), fmt::format("hilda {} ({})", text("version"), text("git")),
                      inputs_of(provenance->value)};
    }
    return {};
}

/// The record of a result, or that of a run with several integrators, each of which has a folder.
Record read_record(const fs::path& directory)
{
    if (const std::optional<Record> found = record_in(directory)) return *found;
    std::vector<fs::path> folders;
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(directory))
        if (entry.is_directory(error)) folders.push_back(entry.path());
    std::sort(folders.begin(), folders.end());
    std::optional<Record> common;
    for (const fs::path& folder : folders) {
        const std::optional<Record> found = record_in(folder);
        if (!found) continue;
        if (!common) common = found;
        if (common->command != found->command)
            throw io::InvalidInput(directory.string() + ": contains the results of several commands, " +
                                   common->file + " and " + found->file + "; repeat one of them");
    }
    if (!common)
        throw io::InvalidInput(
            directory.string() +
            ": contains no summary.json, study.json or fit.json, which record the command");
    return *common;
}

/// Whether a path is a folder or lies in it. Both are canonical.
bool contains(const fs::path& folder, const fs::path& path)
{
    return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

/// Where the results of the repetition are that belong to those of `directory`, which may be the folder of
/// one of several integrators
fs::path repetition_of(const fs::path& directory, const fs::path& output)
{
    const fs::path part = output / directory.filename();
    std::error_code error;
    return !record_in(output) && record_in(directory) && fs::is_directory(part, error) ? part : output;
}

/// The command with another output directory. --force and --resume are removed. Words behind "--" are no
/// options.
std::vector<std::string> with_output(const std::vector<std::string>& words, const std::string& output)
{
    std::vector<std::string> all;
    size_t k = 0;
    for (; k < words.size() && words[k] != "--"; ++k) {
        if (words[k] == "--output") {
            ++k;
        } else if (!words[k].starts_with("--output=") && words[k] != "--force" && words[k] != "--resume") {
            all.push_back(words[k]);
        }
    }
    all.insert(all.end(), {"--output", output});
    all.insert(all.end(), words.begin() + static_cast<std::ptrdiff_t>(std::min(k, words.size())),
               words.end());
    return all;
}

/// The number of the options --load FILE before the command. io::UsageError unless `plugins` are these.
size_t loaded_by(const std::vector<std::string>& words, const std::string& file, const RerunOptions& options)
{
    size_t k = 1;
    while (k < words.size() && words[k].starts_with("--load")) {
        const bool in_one = words[k].starts_with("--load=");
        if (!in_one && k + 1 == words.size()) break;
        const std::string plugin = in_one ? words[k].substr(7) : words[k + 1];
        k += in_one ? 1 : 2;
        std::error_code error;
        const std::string path = fs::weakly_canonical(plugin, error).string() + " (";
        if (std::none_of(options.plugins.begin(), options.plugins.end(),
                         [&](const std::string& loaded) { return loaded.starts_with(path); }))
            throw io::UsageError(
                fmt::format("{}: the command loads the plug-in {}, whose code would be executed; "
                            "hilda --load {} rerun {} permits it",
                            file, plugin, plugin, options.directory));
    }
    return k;
}

/// io::InvalidInput unless the command writes a result to --output and nothing else.
void refuse_other_command(const std::vector<std::string>& words, const std::string& program,
                          const Record& record, const RerunOptions& options)
{
    static constexpr std::string_view repeatable[] = {"run",     "study", "fit",     "kinematics",
                                                      "inverse", "cosim", "collect", "granular"};
    static constexpr std::string_view of_other_files[] = {"--write", "--lammps", "--exchange"};
    size_t k = 1;
    if (program == "hilda") {
        k = loaded_by(words, record.file, options);
        const std::string command = k < words.size() ? words[k] : "";
        if (std::find(std::begin(repeatable), std::end(repeatable), command) == std::end(repeatable))
            throw io::InvalidInput(fmt::format("{}: the command '{}' is not repeated; hilda rerun repeats {}",
                                               record.file, command, fmt::join(repeatable, ", ")));
    }
    for (; k < words.size() && words[k] != "--"; ++k)
        for (const std::string_view option : of_other_files)
            if (words[k].starts_with(option))
                throw io::InvalidInput(fmt::format(
                    "{}: a command with {} is not repeated: it writes no result", record.file, option));
}

/// Runs a program and waits for it. Returns its exit code.
int run(const std::string& program, std::vector<std::string> words)
{
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    pid_t child = 0;
    if (posix_spawn(&child, program.c_str(), nullptr, nullptr, argv.data(), environ) != 0)
        throw io::NotAvailable("rerun: " + program + " cannot be started");
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : io::exit_code::signal + WTERMSIG(status);
}

}  // namespace

std::vector<std::string> shell_words(const std::string& text)
{
    std::vector<std::string> words;
    bool in_word = false;
    for (size_t k = 0; k < text.size(); ++k) {
        const char c = text[k];
        if (c == ' ') {
            in_word = false;
            continue;
        }
        if (!in_word) words.emplace_back();
        in_word = true;
        if (c == '\'') {
            const size_t end = text.find('\'', k + 1);
            if (end == std::string::npos)
                throw io::InvalidInput("the command line has an open quotation mark: " + text);
            words.back() += text.substr(k + 1, end - k - 1);
            k = end;
        } else if (c == '\\' && k + 1 < text.size()) {
            words.back() += text[++k];
        } else {
            words.back() += c;
        }
    }
    return words;
}

int rerun(const RerunOptions& options)
{
    std::error_code error;
    if (!fs::is_directory(options.directory, error))
        throw io::InvalidInput(options.directory + ": is not a directory; hilda rerun needs a result");
    const fs::path directory = fs::canonical(options.directory);
    const Record record = read_record(options.directory);
    std::vector<std::string> words = shell_words(record.command);
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(directory))
        if (entry.path().extension() == ".h5")
            throw io::InvalidInput(entry.path().string() +
                                   ": tables in HDF5 files are not compared; run again "
                                   "with --format csv");
    if (words.empty()) throw io::InvalidInput(record.file + ": has an empty command line");
    const std::string name = fs::path(words.front()).filename();
    if (name != "hilda" && name != "hilda-granular")
        throw io::InvalidInput(record.file + ": the command is of no program of HILDA: " + record.command);
    refuse_other_command(words, name, record, options);
    std::string output = options.output;
    if (output.empty()) {
        const fs::path given = (fs::path(options.directory) / "").parent_path();
        const bool has_name = given.has_filename() && given.filename() != "." && given.filename() != "..";
        output = (has_name ? given : directory).string() + "-again";
    }
    if (contains(directory, fs::weakly_canonical(output)))
        throw io::InvalidInput(output +
                               ": is in the result that is repeated; --output selects another directory");
    if (!io::is_missing_or_empty(output))
        throw io::InvalidInput(output + ": the directory is not empty; --output selects another one");
    words = with_output(words, output);
    const std::string program =
        name == "hilda" ? fs::read_symlink("/proc/self/exe", error).string() : run::granular_program();
    std::cout << "recorded by   " << record.version << ", repeated by " << run::version_line()
              << "\nrepeats       " << fmt::format("{}\n", fmt::join(words, " ")) << std::flush;
    bool equal = true;
    for (const auto& [file, checksum] : record.inputs) {
        if (io::checksum_of_file(file) == checksum) continue;
        std::cout << "different     input " << file
                  << ": has changed since, or is not in the present folder\n"
                  << std::flush;
        equal = false;
    }
    const int code = run(program, words);
    if (code != io::exit_code::done && code != io::exit_code::numerical_failure) return code;
    for (const FileComparison& file :
         compare_results(directory, repetition_of(directory, output), options.tolerance)) {
        std::cout << fmt::format("{}  {}: {}\n", file.is_equal ? "equal       " : "different   ", file.file,
                                 file.description);
        equal = equal && file.is_equal;
    }
    return equal ? code : io::exit_code::expectation_failed;
}

}  // namespace hilda::studies
