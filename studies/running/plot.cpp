// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/running/plot.hpp"

#include "io/error.hpp"
#include "io/files.hpp"
#include "io/json_source.hpp"
#include "io/message.hpp"
#include "lie/check.hpp"

#include <hilda/version.hpp>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <limits>
#include <sstream>
#include <thread>

extern char** environ;

namespace hilda::studies {

namespace fs = std::filesystem;

namespace {

// Python writes no files beside the scripts, which may be in an installation.
constexpr const char* no_bytecode = "-B";

std::string python()
{
    const char* configured = std::getenv("HILDA_PYTHON");
    return configured != nullptr && *configured != '\0' ? configured : version::python;
}

std::vector<fs::path>& more_places()
{
    static std::vector<fs::path> places;
    return places;
}

/// Path of a script in share/hilda/plots of an installed program, in the source tree or beside a plug-in;
/// empty if there is none
std::string find_script(const std::string& script)
{
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    std::vector<fs::path> places = {program.parent_path().parent_path() / "share/hilda/plots",
                                    fs::path(version::plots)};
    places.insert(places.end(), more_places().begin(), more_places().end());
    for (const fs::path& place : places)
        if (fs::is_regular_file(place / script, error)) return place / script;
    return {};
}

struct ProcessResult {
    int code = -1;          ///< -1: the process could not be started; 128 + N: ended by signal N
    std::string output;     ///< stdout and stderr together
    bool too_slow = false;  ///< killed at the time limit
};

using Clock = std::chrono::steady_clock;

/// Time until `end`, for poll(). At least 0
int milliseconds_until(Clock::time_point end)
{
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - Clock::now()).count();
    return static_cast<int>(std::clamp<decltype(left)>(left, 0, std::numeric_limits<int>::max()));
}

/// Appends what is read until the end of the file. False at the time limit
bool read_until(int descriptor, Clock::time_point end, std::string& output)
{
    std::array<char, 4096> chunk{};
    while (true) {
        pollfd ready = {.fd = descriptor, .events = POLLIN, .revents = 0};
        const int left = milliseconds_until(end), polled = poll(&ready, 1, left);
        if (polled == 0 || left == 0) return false;
        if (polled < 0 && errno == EINTR) continue;
        const ssize_t n = read(descriptor, chunk.data(), chunk.size());
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return true;
        if (output.size() < 1 << 20) output.append(chunk.data(), static_cast<size_t>(n));
    }
}

/// Waits for the end of a process. False at the time limit
bool wait_until(pid_t child, Clock::time_point end, int& status)
{
    while (true) {
        const pid_t ended = waitpid(child, &status, WNOHANG);
        if (ended == child || (ended < 0 && errno != EINTR)) return true;
        if (milliseconds_until(end) == 0) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
}

/// Runs a program without a shell and waits for it, at most `limit` seconds. At most about 1 MiB of its
/// output is stored.
ProcessResult run(std::vector<std::string> words, double limit)
{
    const Clock::time_point end =
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(limit));
    std::array<int, 2> pipe_ends{};
    if (pipe2(pipe_ends.data(), O_CLOEXEC) != 0) return {};
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);

    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, pipe_ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, pipe_ends[1], STDERR_FILENO);
    pid_t child = 0;
    const int error = posix_spawnp(&child, argv[0], &actions, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    close(pipe_ends[1]);

    ProcessResult result;
    if (error == 0) {
        int status = 0;
        result.too_slow = !read_until(pipe_ends[0], end, result.output) || !wait_until(child, end, status);
        if (result.too_slow) {
            kill(child, SIGKILL);
            while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
            }
        }
        result.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    close(pipe_ends[0]);
    return result;
}

std::string last_line(std::string text)
{
    while (!text.empty() && text.back() == '\n') text.pop_back();
    return text.substr(text.rfind('\n') + 1);
}

/// One line with the reason why a Python process failed; empty if it succeeded
std::string failure_reason(const ProcessResult& result, double limit)
{
    if (result.too_slow) return fmt::format("{} did not end within {:g} s and was stopped", python(), limit);
    if (result.code == 0) return {};
    if (result.code > 128)
        return fmt::format("{} was ended by signal {} ({})", python(), result.code - 128,
                           strsignal(result.code - 128));
    if (result.code == -1 || result.code == 127)
        return python() + " was not found (Debian: apt-get install python3-matplotlib)";
    if (result.output.find("No module named 'matplotlib'") != std::string::npos)
        return python() + " has no matplotlib (Debian: apt-get install python3-matplotlib)";
    if (result.output.find("No module named 'numpy'") != std::string::npos)
        return python() + " has no NumPy (Debian: apt-get install python3-numpy)";
    const std::string line = last_line(result.output);
    return line.empty()
               ? fmt::format("{} ended with the exit code {} and without a message", python(), result.code)
               : line;
}

}  // namespace

void add_script_directory(const std::string& directory) { more_places().emplace_back(directory); }

const std::vector<std::string>& figure_formats()
{
    static const std::vector<std::string> all = {"png",  "pdf", "svg",  "eps", "ps",  "svgz",
                                                 "jpeg", "jpg", "tiff", "tif", "webp"};
    return all;
}

std::optional<std::vector<std::string>> plot(const std::string& script, const std::string& directory,
                                             const FigureOptions& options)
{
    const std::string path = find_script(script);
    std::vector<std::string> words = {python(), no_bytecode, path, directory};
    const auto add = [&](const char* option, const std::vector<std::string>& values) {
        if (values.empty()) return;
        words.emplace_back(option);
        words.push_back(fmt::format("{}", fmt::join(values, ",")));
    };
    add("--format", options.formats);
    add("--integrator", options.integrators);
    add("--quantity", options.quantities);
    const ProcessResult result = path.empty() ? ProcessResult{} : run(std::move(words), options.time_limit);
    constexpr int refused = 2;  // see studies/plots/options.py
    if (result.code == refused && !(options.integrators.empty() && options.quantities.empty()))
        throw io::UsageError("plot: " + last_line(result.output));
    constexpr int damaged = 5;  // see studies/plots/drawing.py
    if (result.code == damaged) throw io::IoError(last_line(result.output));
    const std::string why =
        path.empty() ? "the script " + script + " was not found" : failure_reason(result, options.time_limit);
    if (!why.empty()) {
        io::warning("no figures: " + why);
        return std::nullopt;
    }
    std::vector<std::string> files;
    std::istringstream lines(result.output);
    std::error_code error;
    for (std::string line; std::getline(lines, line);)
        if (!line.empty() && fs::is_regular_file(fs::path(directory) / line, error)) files.push_back(line);
    if (files.empty()) {
        io::warning("no figures: " + python() + " has written none" +
                    (result.output.empty() ? "" : ": " + last_line(result.output)));
        return std::nullopt;
    }
    return files;
}

void start_script(const std::string& script, const std::vector<std::string>& arguments)
{
    std::vector<std::string> words = {python(), no_bytecode, find_script(script)};
    if (words.back().empty()) throw io::NotAvailable("the script " + script + " was not found");
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    std::cout.flush();
    execvp(argv[0], argv.data());
    throw io::NotAvailable(python() + " was not found (Debian: apt-get install python3-numpy)");
}

void remove_figure(const std::string& directory, const std::string& name)
{
    std::error_code error;
    for (const std::string& format : figure_formats())
        fs::remove((fs::path(directory) / name).replace_extension(format), error);
}

std::vector<std::string> existing_figures(const std::string& directory, const std::string& name,
                                          const std::vector<std::string>& formats)
{
    std::vector<std::string> files;
    std::error_code error;
    for (const std::string& format : formats.empty() ? std::vector<std::string>{"png"} : formats) {
        const std::string file = fs::path(name).replace_extension(format).string();
        if (fs::is_regular_file(fs::path(directory) / file, error)) files.push_back(file);
    }
    return files;
}

std::string script_for(const std::string& directory)
{
    std::error_code error;
    if (fs::is_regular_file(fs::path(directory) / "study.csv", error)) {
        const std::string record = directory + "/study.json";
        const io::JsonSource study(io::read_file(record, io::JsonSource::max_bytes), record,
                                   io::JsonSource::max_bytes);
        const io::Json::Member* kind = study.root.member("study");
        if (kind == nullptr || kind->value.string() == nullptr ||
            kind->value.string()->find('/') != std::string::npos)
            throw lie::InvalidInput(record +
                                    ": the key 'study' is missing or invalid; expected the name of a study");
        return *kind->value.string() + ".py";
    }
    for (const char* table : {"trajectory.csv", "run.h5"})
        if (fs::is_regular_file(fs::path(directory) / table, error)) return "trajectory.py";
    if (fs::is_regular_file(fs::path(directory) / "run.csv", error)) return "granular-run.py";
    if (fs::is_regular_file(fs::path(directory) / "fit.csv", error)) return "fit.py";
    throw lie::InvalidInput(
        directory +
        ": contains no study.csv, trajectory.csv, run.h5, run.csv or fit.csv; hilda plot needs one of them");
}

std::string python_and_matplotlib()
{
    const ProcessResult result =
        run({python(), "-c",
             // Without the current folder, in which there may be another matplotlib.py
             "import sys; sys.path = [p for p in sys.path if p]; import matplotlib; "
             "print(sys.version.split()[0] + ', matplotlib ' + matplotlib.__version__)"},
            FigureOptions{}.time_limit);
    const std::string why = failure_reason(result, FigureOptions{}.time_limit);
    return why.empty() ? python() + " " + last_line(result.output) : why;
}

}  // namespace hilda::studies
