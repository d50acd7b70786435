// SPDX-License-Identifier: GPL-3.0-or-later
// The house keeps its shape: which room may include which, no catch-all folders, a small top level.
#include <catch2/catch.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace fs = std::filesystem;

namespace {

const fs::path root = HILDA_SOURCE_DIR;
const std::set<std::string> rooms = {"lie", "dae", "contact", "granular", "reference", "tests", "studies"};

/// What each room may include of ours, besides itself.
const std::map<std::string, std::set<std::string>> below = {
    {"lie", {}},
    {"dae", {"lie"}},
    {"contact", {"dae", "lie"}},
    {"granular", {}},  // but for granular/cosim, which sees dae, and formula.cpp of its program
    {"reference", {"dae", "lie"}},
    {"studies", {"lie", "dae", "contact", "granular", "reference"}},
    {"tests", {"lie", "dae", "contact", "granular", "reference", "studies"}},
};

/// Libraries that must stay out of a room, by the first folder of their headers. GSL under a room would put
/// the GPL on whoever links it, and could then not go with the CUDA runtime.
const std::map<std::string, std::set<std::string>> kept_out = {
    {"lie",
     {"gsl", "nlohmann", "fmt", "spdlog", "CLI", "ida", "nvector", "sundials", "sunmatrix", "sunlinsol"}},
    {"dae", {"gsl", "spdlog", "CLI", "ida", "nvector", "sundials", "sunmatrix", "sunlinsol"}},
    {"contact", {"gsl", "spdlog", "CLI", "ida", "nvector", "sundials", "sunmatrix", "sunlinsol"}},
    {"granular", {"gsl", "Eigen", "ida", "nvector", "sundials", "sunmatrix", "sunlinsol"}},
};

/// Why `file` may not include `header` (both from the root of the tree), or an empty string.
std::string objection(const std::string& file, const std::string& header)
{
    const std::string room = file.substr(0, file.find('/'));
    const std::string other = header.substr(0, header.find('/'));
    if (header.find("..") != std::string::npos)
        return "is written with '..': write it from the root of the tree";
    if (const auto out = kept_out.find(room); out != kept_out.end() && out->second.count(other) != 0)
        return other + " stays out of " + room;
    if (rooms.count(other) == 0 || other == room) return "";
    if (room == "tests" && other == "studies" && header.ends_with(".cpp")) return "is a source of studies";
    if (file.starts_with("granular/cosim") && other == "dae") return "";
    // The program reads formulas by the grammar of the model files; the room itself takes any that it is given.
    if (file == "granular/program/formula.cpp" && header == "dae/expression.hpp") return "";
    if (below.at(room).count(other) == 0) return room + " must not know " + other;
    return "";
}

bool is_source(const fs::path& p)
{
    static const std::set<std::string> endings = {".hpp", ".cpp", ".h", ".cu", ".cuh"};
    return endings.count(p.extension().string()) != 0;
}

/// All files and folders of the rooms that exist, relative to the root.
std::vector<fs::path> in_the_rooms()
{
    std::vector<fs::path> found;
    for (const std::string& room : rooms) {
        if (!fs::exists(root / room)) continue;
        for (const auto& entry : fs::recursive_directory_iterator(root / room))
            found.push_back(fs::relative(entry.path(), root));
    }
    return found;
}

/// The first parts of all paths that git tracks; nothing where there is no git.
std::set<std::string> tracked_top_level()
{
    std::set<std::string> top;
    if (!fs::exists(root / ".git")) return top;
    const std::string command = "git --no-optional-locks -C '" + root.string() + "' ls-files 2>/dev/null";
    FILE* pipe = popen(command.c_str(), "r");
    if (pipe == nullptr) return top;
    std::string path;
    for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) {
        if (c != '\n') {
            path += static_cast<char>(c);
            continue;
        }
        top.insert(path.substr(0, path.find('/')));
        path.clear();
    }
    pclose(pipe);
    return top;
}

}  // namespace

TEST_CASE("a turned arrow is found", "[house]")
{
    CHECK(objection("lie/so3.cpp", "dae/model.hpp") == "lie must not know dae");
    CHECK(objection("dae/model.hpp", "studies/table.hpp") == "dae must not know studies");
    CHECK(objection("reference/closed_form.cpp", "contact/surface.hpp") == "reference must not know contact");
    CHECK(objection("granular/world.hpp", "dae/model.hpp") == "granular must not know dae");
    CHECK(objection("studies/main.cpp", "tests/support/random_motion.hpp") == "studies must not know tests");
    CHECK(objection("tests/lie/so3_test.cpp", "studies/main.cpp") == "is a source of studies");
    CHECK(objection("dae/start.cpp", "gsl/gsl_odeiv2.h") == "gsl stays out of dae");
    CHECK(objection("dae/start.cpp", "sunlinsol/sunlinsol_klu.h") == "sunlinsol stays out of dae");
    CHECK(objection("dae/start.cpp", "../lie/so3.hpp") != "");

    CHECK(objection("granular/program/run.cpp", "dae/expression.hpp") == "granular must not know dae");
    CHECK(objection("granular/program/formula.cpp", "dae/model.hpp") == "granular must not know dae");

    CHECK(objection("granular/program/formula.cpp", "dae/expression.hpp") == "");
    CHECK(objection("dae/model.hpp", "lie/system.hpp") == "");
    CHECK(objection("granular/cosim.cpp", "dae/model.hpp") == "");
    CHECK(objection("tests/studies/table_test.cpp", "studies/table.hpp") == "");
    CHECK(objection("reference/closed_form.cpp", "gsl/gsl_odeiv2.h") == "");
    CHECK(objection("reference/ida_solver.cpp", "ida/ida.h") == "");
}

TEST_CASE("no arrow between the rooms turns round", "[house]")
{
    static const std::regex include_line(R"re(^\s*#\s*include\s*["<]([^">]+)[">])re");
    int read = 0;
    for (const fs::path& p : in_the_rooms()) {
        if (!is_source(p)) continue;
        ++read;
        std::ifstream in(root / p);
        std::string line;
        for (int number = 1; std::getline(in, line); ++number) {
            std::smatch m;
            if (!std::regex_search(line, m, include_line)) continue;
            const std::string why = objection(p.generic_string(), m[1].str());
            if (!why.empty())
                FAIL_CHECK(p.generic_string() << ":" << number << ": " << m[1].str() << ": " << why);
        }
    }
    CHECK(read > 0);
}

TEST_CASE("there is no catch-all folder or file", "[house]")
{
    const std::set<std::string> catch_all = {"util",   "utils", "utility", "utilities",
                                             "common", "core",  "misc"};
    for (const fs::path& p : in_the_rooms()) {
        INFO(p.generic_string());
        CHECK(catch_all.count(p.stem().string()) == 0);
    }
}

TEST_CASE("the top level of the tree is what the house says", "[house]")
{
    const std::set<std::string> always = {
        "CMakeLists.txt", "CMakePresets.json", "README.md",   "LICENSE", ".ci", "cmake",
        ".gitignore",     ".clang-format",     ".clang-tidy", "lie",     "dae", "tests",
    };
    std::set<std::string> allowed = always;
    allowed.insert({"contact", "granular", "reference", "studies"});  // each comes with its first content

    const std::set<std::string> top = tracked_top_level();
    if (top.empty()) {
        WARN("no git here: the top level was not looked at");
        return;
    }
    for (const std::string& name : top) {
        INFO(name << " is tracked but has no place at the top level");
        CHECK(allowed.count(name) == 1);
    }
    for (const std::string& name : always) {
        INFO(name << " is missing");
        CHECK(top.count(name) == 1);
    }
}
