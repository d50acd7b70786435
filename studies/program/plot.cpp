// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/plot.hpp"

#include "io/error.hpp"
#include "io/files.hpp"
#include "io/json_source.hpp"
#include "io/message.hpp"
#include "io/program.hpp"
#include "lie/check.hpp"

#include <hilda/version.hpp>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
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
    int code = -1;             ///< -1: the process could not be started; 128 + N: ended by signal N
    std::string output;        ///< stdout and stderr together
    bool interrupted = false;  ///< ended because this process has received a signal
};

/// The end of the present process is requested by a signal that has come since the construction. See
/// io::Interrupt.
class NewSignal {
public:
    bool has_come() const { return io::Interrupt::caught() != before; }

private:
    const int before = io::Interrupt::caught();
};

// A signal may be received by another thread, and does not end poll() then.
constexpr int signal_test_interval = 50;  // [ms]

/// Appends what is read until the end of the file. False after a signal
bool read_all(int descriptor, const NewSignal& signal, std::string& output)
{
    std::array<char, 4096> chunk{};
    while (!signal.has_come()) {
        pollfd ready = {.fd = descriptor, .events = POLLIN, .revents = 0};
        const int polled = poll(&ready, 1, signal_test_interval);
        if (polled == 0 || (polled < 0 && errno == EINTR)) continue;
        const ssize_t n = read(descriptor, chunk.data(), chunk.size());
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return true;
        if (output.size() < 1 << 20) output.append(chunk.data(), static_cast<size_t>(n));
    }
    return false;
}

/// Waits for the end of a process. False after a signal
bool wait_for_end(pid_t child, const NewSignal& signal, int& status)
{
    while (!signal.has_come()) {
        const pid_t ended = waitpid(child, &status, WNOHANG);
        if (ended == child || (ended < 0 && errno != EINTR)) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return false;
}

/// Runs a program without a shell and waits for it. At most about 1 MiB of its output is stored. There is no
/// time limit: a figure takes long on a busy machine. SIGINT, SIGTERM and SIGHUP end the program.
ProcessResult run_until(const NewSignal& signal, std::vector<std::string> words)
{
    const io::Interrupt interrupt;
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
        result.interrupted =
            !read_all(pipe_ends[0], signal, result.output) || !wait_for_end(child, signal, status);
        if (result.interrupted) {
            kill(child, SIGKILL);
            while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
            }
        }
        result.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    close(pipe_ends[0]);
    return result;
}

/// The same. The present process then receives the signal again, with the handlers of before.
ProcessResult run(std::vector<std::string> words)
{
    const NewSignal signal;
    ProcessResult result = run_until(signal, std::move(words));
    if (signal.has_come()) {
        const int number = io::Interrupt::caught();
        io::Interrupt::forget();
        std::raise(number);
    }
    return result;
}

/// One line with the reason why a Python process failed; empty if it succeeded
std::string failure_reason(const ProcessResult& result)
{
    if (result.interrupted) return "interrupted; hilda plot draws them";
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

std::string last_line(std::string text)
{
    while (!text.empty() && text.back() == '\n') text.pop_back();
    return text.substr(text.rfind('\n') + 1);
}

void add_script_directory(const std::string& directory) { more_places().emplace_back(directory); }

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
    const ProcessResult result = path.empty() ? ProcessResult{} : run(std::move(words));
    constexpr int refused = 2;  // see studies/plots/options.py
    if (result.code == refused && !(options.integrators.empty() && options.quantities.empty()))
        throw io::UsageError("plot: " + last_line(result.output));
    if (result.code == io::exit_code::invalid_input) throw io::InvalidInput(last_line(result.output));
    if (result.code == io::exit_code::input_output) throw io::IoError(last_line(result.output));
    const std::string why = path.empty() ? "the script " + script + " was not found" : failure_reason(result);
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

std::vector<std::string> draw_figures(const std::string& script, const std::string& directory,
                                      const std::vector<std::string>& formats)
{
    try {
        return plot(script, directory, {.formats = formats}).value_or(std::vector<std::string>{});
    } catch (const std::exception& error) {  // the results are complete without figures
        io::warning("no figures: " + std::string(error.what()));
        return {};
    }
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
             "print(sys.version.split()[0] + ', matplotlib ' + matplotlib.__version__)"});
    const std::string why = failure_reason(result);
    return why.empty() ? python() + " " + last_line(result.output) : why;
}

}  // namespace hilda::studies
