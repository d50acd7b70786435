// SPDX-License-Identifier: GPL-3.0-or-later
/// Calls of the program in a process of its own: exit code, output and files.

#pragma once

#include "tests/support/paths.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace hilda::tests {

namespace fs = std::filesystem;

inline std::string read(const fs::path& file)
{
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

inline void write(const fs::path& file, const std::string& text)
{
    std::ofstream(file, std::ios::binary) << text;
}

inline std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

/// A temporary directory, removed by the destructor
class Scratch {
public:
    Scratch()
    {
        std::string name = (fs::temp_directory_path() / "hilda-test-XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary directory");
        path = name;
    }
    ~Scratch() { fs::remove_all(path); }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;

    fs::path operator/(const std::string& name) const { return path / name; }

    fs::path path;
};

struct Ended {
    int code = 0;  ///< exit code, or 128 + number of the signal that ended the process
    std::string out, err;
};

/// The arguments followed by more of them
inline std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more)
{
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

/// Ends the process at a known write to a file (tests/support/end_at_write.cpp). The files and the exit code
/// do not depend on the speed of the machine.
struct EndAt {
    int signal = 0;         ///< 0: the process is not ended; -signal: its parent gets the signal
    long write = 1;         ///< number of the write to the file, from 1; the signal comes in the middle of it
    std::string file = {};  ///< end of the path of the file
};

/// Conditions of a call
struct Limits {
    long file_bytes = 0;         ///< largest size of a file; 0: no limit
    std::string stdout_to = {};  ///< file for stdout; "": a temporary file that is read back
    std::string python = {};     ///< value of HILDA_PYTHON; "": unchanged
    EndAt end_at = {};
};

/// The running program, in a scratch directory
class Program {
public:
    Program(const Scratch& in, const std::vector<std::string>& arguments, const Limits& limits = {})
        : out(limits.stdout_to.empty() ? in / ".out" : fs::path(limits.stdout_to)), err(in / ".err")
    {
        std::vector<std::string> words = {limits.end_at.signal == 0 ? hilda_program : hilda_ending_program};
        words.insert(words.end(), arguments.begin(), arguments.end());
        std::vector<char*> argv;
        for (std::string& word : words) argv.push_back(word.data());
        argv.push_back(nullptr);
        child = fork();
        if (child != 0) return;
        for (const auto& [file, descriptor] : {std::pair(out, STDOUT_FILENO), std::pair(err, STDERR_FILENO)})
            dup2(open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666), descriptor);
        if (!limits.python.empty()) setenv("HILDA_PYTHON", limits.python.c_str(), 1);
        if (const EndAt& end = limits.end_at; end.signal != 0)
            setenv("HILDA_END_AT",
                   (std::to_string(end.signal) + ' ' + std::to_string(end.write) + ' ' + end.file).c_str(),
                   1);
        if (chdir(in.path.c_str()) != 0) _exit(126);
        if (limits.file_bytes > 0) {
            const rlimit most{static_cast<rlim_t>(limits.file_bytes), static_cast<rlim_t>(limits.file_bytes)};
            setrlimit(RLIMIT_FSIZE, &most);
        }
        execv(argv[0], argv.data());
        _exit(127);
    }

    void send(int signal) const { kill(child, signal); }

    Ended wait() const
    {
        int status = 0;
        waitpid(child, &status, 0);
        return {.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
                .out = out.filename() == ".out" ? read(out) : "",
                .err = read(err)};
    }

private:
    fs::path out, err;
    pid_t child = 0;
};

inline Ended call(const Scratch& in, const std::vector<std::string>& arguments, const Limits& limits = {})
{
    return Program(in, arguments, limits).wait();
}

/// Waits until a file exists and is not empty; false after ten seconds
inline bool appears(const fs::path& file)
{
    std::error_code error;
    for (int k = 0; k < 5000; ++k) {
        if (fs::exists(file, error) && fs::file_size(file, error) > 0) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return false;
}

/// A model file of a bar with a revolute joint, and additional constraints and forces
inline std::string pendulum(const std::string& more_constraints = "", const std::string& forces = "")
{
    return R"({"hilda_model": 1, "name": "pendulum", "end": 1.0,
 "bodies": [{"name": "bar", "mass": 2, "inertia": [0.7, 0.1, 0.7], "r": [0, 1, 0], "A": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}],
 "constraints": [{"name": "hinge", "type": "revolute", "body_i": "bar", "body_j": "ground", "s_bar_p_i": [0, -1, 0],
                  "s_bar_q_j": [0, 0, 0], "axis_bar_i": [1, 0, 0], "axis_bar_j": [1, 0, 0]})" +
           more_constraints + R"(],
 "forces": [)" +
           forces + R"(]}
)";
}

}  // namespace hilda::tests
