// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/cosim/grain_process.hpp"

#include "io/error.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>

#include <fcntl.h>
#include <unistd.h>

namespace hilda::studies {

std::unique_ptr<granular::RemoteExchange> start_grains(const std::vector<std::string>& arguments,
                                                       const std::vector<std::string>& names)
{
    std::error_code error;
    const auto here = std::filesystem::read_symlink("/proc/self/exe", error);
    const std::string program = (here.parent_path() / "hilda-granular").string();
    std::vector<char*> words = {const_cast<char*>("hilda-granular")};
    for (const std::string& a : arguments) words.push_back(const_cast<char*>(a.c_str()));
    words.push_back(const_cast<char*>("--exchange"));
    words.push_back(nullptr);
    const auto fail = [&] {
        throw io::NotAvailable("cosim: " + program + " cannot be started: " + std::strerror(errno));
    };
    if (error || access(program.c_str(), X_OK) != 0) fail();
    int to_grains[2], from_grains[2];
    if (pipe2(to_grains, O_CLOEXEC) != 0 || pipe2(from_grains, O_CLOEXEC) != 0) fail();
    const pid_t child = fork();
    if (child < 0) fail();
    if (child == 0) {
        if (dup2(to_grains[0], STDIN_FILENO) < 0 || dup2(from_grains[1], STDOUT_FILENO) < 0) _exit(127);
        execv(program.c_str(), words.data());
        _exit(127);
    }
    close(to_grains[0]), close(from_grains[1]);
    return std::make_unique<granular::RemoteExchange>(
        std::make_unique<granular::Channel>(from_grains[0], to_grains[1], "hilda-granular"), names);
}

}  // namespace hilda::studies
