// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/cosim/grain_process.hpp"

#include "io/error.hpp"
#include "run/cosim/granular_program.hpp"

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace hilda::run {

std::unique_ptr<granular::RemoteExchange> start_grains(const std::vector<std::string>& arguments,
                                                       const std::vector<std::string>& names)
{
    const std::string program = granular_program();
    std::vector<char*> words = {const_cast<char*>("hilda-granular")};
    for (const std::string& a : arguments) words.push_back(const_cast<char*>(a.c_str()));
    words.push_back(const_cast<char*>("--exchange"));
    words.push_back(nullptr);
    const auto fail = [&] {
        throw io::NotAvailable("cosim: " + program + " cannot be started: " + std::strerror(errno));
    };
    if (access(program.c_str(), X_OK) != 0) fail();
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
    auto channel = std::make_unique<granular::PipeChannel>(from_grains[0], to_grains[1], "hilda-granular");
    try {
        return std::make_unique<granular::RemoteExchange>(std::move(channel), names);
    } catch (const granular::ExchangeLost&) {
        int status = 0;
        if (waitpid(child, &status, 0) != child || !WIFEXITED(status) || WEXITSTATUS(status) == 0) throw;
        throw io::Failure(WEXITSTATUS(status),
                          "cosim: hilda-granular has ended with this exit code; its message is above");
    }
}

}  // namespace hilda::run
