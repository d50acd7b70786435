// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/cosim/granular_program.hpp"

#include "io/error.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>

#include <unistd.h>

namespace hilda::run {

std::string granular_program()
{
    std::error_code error;
    const auto here = std::filesystem::read_symlink("/proc/self/exe", error);
    return error ? "" : (here.parent_path() / "hilda-granular").string();
}

int start_granular(const std::vector<std::string>& arguments)
{
    const std::string program = granular_program();
    std::vector<char*> words = {const_cast<char*>("hilda granular")};
    for (const std::string& a : arguments) words.push_back(const_cast<char*>(a.c_str()));
    words.push_back(nullptr);
    if (!program.empty()) execv(program.c_str(), words.data());
    if (errno == ENOENT)
        throw io::NotAvailable("granular: " + program +
                               " was not built; './studies/run granular laws' in the source tree builds it "
                               "(target hilda_granular_program), and the Debian package hilda has it");
    throw io::NotAvailable("granular: " + program + " cannot be started: " + std::strerror(errno));
}

}  // namespace hilda::run
