// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/provenance.hpp"

#include "io/archive.hpp"
#include "io/files.hpp"
#include "io/message.hpp"

#include <filesystem>
#include <fstream>
#include <limits>
#include <set>

namespace hilda::io {

std::string processor()
{
    std::ifstream in("/proc/cpuinfo");
    for (std::string line; std::getline(in, line);)
        if (line.starts_with("model name"))
            if (const size_t at = line.find(": "); at != std::string::npos) return line.substr(at + 2);
    return "unknown";
}

Json provenance(const Build& build, const std::vector<std::pair<std::string, std::string>>& libraries,
                const std::string& command_line, int threads)
{
    Json all = Json::object();
    for (const auto& [library, number] : libraries) all[library] = number;
    return {{"version", build.number},      {"git", build.git},           {"build_type", build.build_type},
            {"flags", build.flags},         {"compiler", build.compiler}, {"libraries", all},
            {"command_line", command_line}, {"cpu", processor()},         {"threads", threads}};
}

std::string checksum_of_file(const std::string& file)
{
    try {
        const std::string bytes = read_file(file, std::numeric_limits<std::size_t>::max());
        return formatted("%016llx", static_cast<unsigned long long>(checksum(bytes.data(), bytes.size())));
    } catch (const IoError&) {
        return "";
    }
}

Json inputs(const std::vector<std::string>& files)
{
    Json all = Json::array();
    std::set<std::string> listed;
    for (const std::string& file : files) {
        if (!listed.insert(file).second) continue;
        Json one = {{"file", file}};
        if (const std::string sum = checksum_of_file(file); !sum.empty()) {
            std::error_code error;
            one["bytes"] = static_cast<double>(std::filesystem::file_size(file, error));
            one["checksum"] = sum;
        }
        all.push_back(std::move(one));
    }
    return all;
}

std::string shell_quoted(int argc, char** argv)
{
    std::string line;
    for (int k = 0; k < argc; ++k) {
        const std::string word = argv[k];
        const bool plain = !word.empty() && word.find_first_not_of(
                                                "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                                "0123456789_-+=/.,:@%") == std::string::npos;
        line += k > 0 ? " " : "";
        if (plain) {
            line += word;
            continue;
        }
        line += '\'';
        for (const char c : word) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
        line += '\'';
    }
    return line;
}

}  // namespace hilda::io
