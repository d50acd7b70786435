// SPDX-License-Identifier: GPL-3.0-or-later
// Tests of the layout of the source tree: allowed includes between the rooms and between the folders of
// granular, the folders of each room, the number of units in a folder, the width of comments, no catch-all
// folders, and the entries of the top level.
#include "tests/support/paths.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace fs = std::filesystem;

namespace {

const fs::path root = hilda::tests::source_dir;
const std::set<std::string> rooms = {"io",        "lie", "dae",     "contact", "granular",
                                     "reference", "run", "studies", "python",  "tests"};

/// The rooms that each room may include, besides itself.
const std::map<std::string, std::set<std::string>> allowed_rooms = {
    {"io", {}},
    {"lie", {"io"}},
    {"dae", {"io", "lie"}},
    {"contact", {"io", "dae", "lie"}},
    {"granular", {"io"}},
    {"reference", {"io", "dae", "lie"}},
    {"run", {"io", "lie", "dae", "contact", "granular", "reference"}},
    {"studies", {"io", "lie", "dae", "contact", "granular", "reference", "run"}},
    {"python", {"io", "lie", "dae", "contact", "granular", "reference", "run", "studies"}},
    {"tests", {"io", "lie", "dae", "contact", "granular", "reference", "run", "studies"}},
};

/// Folders of a room, and those that each of them may include, besides itself. A folder stands for its
/// subfolders as well; "" are the files of the room itself.
using FolderOrder = std::map<std::string, std::set<std::string>>;

/// backend and core include each other: core computes with the numbers and parallel loops of backend, and the
/// engines in backend are the loops over the particles of core. The laws in force_models include core, and
/// core has them by the generated header granular/force_models.hpp.
const FolderOrder granular_folders = {
    {"backend", {"core"}},
    {"core", {"backend"}},
    {"force_models", {"backend", "core"}},
    {"distributed", {"backend", "core"}},
    {"mesh", {"backend", "core"}},
    {"clumps", {"backend", "core", "mesh"}},
    {"world", {"backend", "core", "clumps", "mesh"}},
    {"fields", {"backend", "core", "world"}},
    {"reading", {"backend", "clumps", "core", "world"}},
    {"insertion", {"backend", "clumps", "core", "mesh", "reading", "world"}},
    {"case", {"backend", "clumps", "core", "fields", "insertion", "mesh", "reading", "world"}},
    {"stages", {"backend", "case", "core", "insertion", "reading", "world"}},
    {"validations", {"backend", "clumps", "core", "insertion", "mesh", "world"}},
    {"running", {"backend", "case", "core", "fields", "insertion", "reading", "stages", "world"}},
    {"cosim", {"case", "core", "running", "stages", "world"}},
    {"program",
     {"backend", "case", "core", "cosim", "distributed", "fields", "reading", "running", "stages",
      "validations", "world"}},
    {"benchmarks", {"cosim", "mesh", "running", "world"}},
};
const std::pair<std::string, std::string> mutual_folders = {"backend", "core"};

const FolderOrder run_folders = {
    {"jobs", {}},
    {"tables", {}},
    {"columns", {"tables"}},
    {"frames", {"columns"}},
    {"watch", {}},
    {"recording", {"columns", "tables", "watch"}},
    {"sinks", {"columns", "frames", "recording", "tables"}},
    {"events", {"columns", "recording", "tables"}},
    {"", {"columns", "events", "recording", "tables", "watch"}},
    {"importing", {""}},
    {"kinematics", {"", "columns", "tables"}},
    {"fitting", {"", "columns", "jobs"}},
    {"cosim", {"", "recording", "watch"}},
};

const FolderOrder studies_folders = {
    {"framework", {}},
    {"problems", {"framework"}},
    {"experiments", {"framework", "problems"}},
    {"benchmarks", {"experiments", "framework"}},
    {"program", {"framework", "problems"}},
};

/// The rooms whose folders have an order
const std::map<std::string, FolderOrder> ordered_rooms = {
    {"granular", granular_folders}, {"run", run_folders}, {"studies", studies_folders}};

/// The folders of each room, relative to it; "" is the room itself.
const std::map<std::string, std::set<std::string>> folders = {
    {"io", {"", "arithmetic", "formats", "schema"}},
    {"lie", {"", "cones", "integrators", "solver", "steps", "tree"}},
    {"dae", {"", "constraints", "curves", "forces", "joints", "outputs", "shapes", "start"}},
    {"contact",
     {"", "compliant", "detection", "evolving", "friction", "friction/laws", "mesh", "normal", "rigid",
      "scenes", "surfaces"}},
    {"granular",
     {"",
      "backend",
      "backend/packs",
      "benchmarks",
      "case",
      "case/particles",
      "cases",
      "clumps",
      "core",
      "core/neighbours",
      "cosim",
      "core/surfaces",
      "distributed",
      "fields",
      "force_models",
      "force_models/cohesion",
      "force_models/normal",
      "force_models/rolling",
      "force_models/spin",
      "force_models/tangential",
      "insertion",
      "mesh",
      "program",
      "running",
      "reading",
      "stages",
      "validations",
      "validations/comparison",
      "world"}},
    {"reference", {"", "formulations", "integrators", "motions", "solvers"}},
    {"run",
     {"", "columns", "cosim", "events", "fitting", "frames", "importing", "jobs", "kinematics", "recording",
      "sinks", "tables", "watch"}},
    {"studies",
     {"", "benchmarks", "experiments", "experiments/chapter3", "experiments/chapter4",
      "experiments/chapter4/friction", "experiments/chapter5", "experiments/chapter7",
      "experiments/chapter7/rigs", "experiments/chapter8", "experiments/sweep", "framework", "plots",
      "plots/viewer", "problems", "program", "program/repeating"}},
    {"python", {"", "bindings", "granular_bindings", "hilda", "hilda_granular"}},
};

/// A folder holds about 20 units. A unit is a header with its sources, or a source alone.
constexpr std::size_t most_units = 21;

/// Libraries that a room must not include, by the first folder of their headers. GSL is under the GPL and
/// must not be linked with the CUDA runtime.
const std::map<std::string, std::set<std::string>> forbidden_libraries = {
    {"io",
     {"gsl", "Eigen", "nlohmann", "fmt", "CLI", "ida", "nvector", "sundials", "sunmatrix", "sunlinsol"}},
    {"lie", {"gsl", "nlohmann", "fmt", "CLI", "ida", "nvector", "sundials", "sunmatrix", "sunlinsol"}},
    {"dae", {"gsl", "nlohmann", "CLI", "ida", "nvector", "sundials", "sunmatrix", "sunlinsol"}},
    {"contact", {"gsl", "nlohmann", "CLI", "ida", "nvector", "sundials", "sunmatrix", "sunlinsol"}},
    {"granular", {"gsl", "Eigen", "nlohmann", "ida", "nvector", "sundials", "sunmatrix", "sunlinsol"}},
};

/// The folder of its room that contains a file; "" for the files of the room itself, such as generated
/// headers
std::string folder_of(const std::string& path)
{
    const std::size_t begin = path.find('/') + 1, end = path.find('/', begin);
    return end == std::string::npos ? "" : path.substr(begin, end - begin);
}

/// The reason why `file` must not include `header`, both in one room; empty if it may.
std::string order_error(const std::string& room, const std::string& file, const std::string& header)
{
    const auto order = ordered_rooms.find(room);
    const std::string from = folder_of(file), to = folder_of(header);
    if (order == ordered_rooms.end() || from == to || (room == "granular" && to.empty())) return "";
    const auto allowed = order->second.find(from);
    if (allowed != order->second.end() && allowed->second.count(to) == 1) return "";
    const auto name = [&](const std::string& folder) { return folder.empty() ? room : room + "/" + folder; };
    return name(from) + " must not include " + name(to);
}

/// The reason why `file` must not include `header` (both relative to the root of the tree); empty if it may.
std::string include_error(const std::string& file, const std::string& header)
{
    const std::string room = file.substr(0, file.find('/'));
    const std::string other = header.substr(0, header.find('/'));
    if (header.find("..") != std::string::npos)
        return "contains '..': write the path from the root of the tree";
    if (const auto out = forbidden_libraries.find(room);
        out != forbidden_libraries.end() && out->second.count(other) != 0)
        return room + " must not include " + other;
    // The module of grains may link the CUDA runtime, the other one links GSL.
    if (file.starts_with("python/granular_bindings/") && rooms.count(other) != 0 && other != "io" &&
        other != "granular" && other != "python")
        return "python/granular_bindings must not include " + other;
    if (file.starts_with("python/bindings/") && other == "granular")
        return "python/bindings must not include granular";
    if (room == other) return order_error(room, file, header);
    if (rooms.count(other) == 0) return "";
    if (room == "tests" && other == "studies" && header.ends_with(".cpp"))
        return "is a source file of studies, not a header";
    if (allowed_rooms.at(room).count(other) == 0) return room + " must not include " + other;
    return "";
}

bool is_source(const fs::path& p)
{
    static const std::set<std::string> endings = {".hpp", ".cpp", ".h", ".cu", ".cuh"};
    return endings.count(p.extension().string()) != 0;
}

/// All files and folders in the rooms, relative to the root.
std::vector<fs::path> paths_in_rooms()
{
    std::vector<fs::path> found;
    for (const std::string& room : rooms) {
        if (!fs::exists(root / room)) continue;
        for (const auto& entry : fs::recursive_directory_iterator(root / room))
            found.push_back(fs::relative(entry.path(), root));
    }
    return found;
}

/// The first components of all paths tracked by git; empty without a git repository.
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

std::vector<std::string> lines_of(const fs::path& file)
{
    std::vector<std::string> all;
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) all.push_back(line);
    return all;
}

/// Whether a line refuses a deviation by a comparison that NaN does not satisfy: `if (error > limit) fail()`
/// in place of `if (!(error <= limit)) fail()`. The refusal is on the same line or on the next one.
bool accepts_nan(const std::string& line, const std::string& next)
{
    static const std::regex test(
        R"(^\s*if \(([^!]*(norm\(\)|determinant\(\)|residual|tolerance|cosine|deviation|squaredNorm\(\))[^!]* (<|>|<=|>=) [^!]*|)"
        R"([^!]* (<|>|<=|>=) [^!]*(norm\(\)|determinant\(\)|tolerance)[^!]*)\)(.*)$)");
    static const std::regex refusal(
        R"(^\s*(throw|return )?\s*(([\w:.]+::|\w+\.)?(reject|refuse\w*|fail\w*)\(|[\w:]*(Error|Input|Failure|NonFinite)[({]).*)");
    std::smatch found;
    if (!std::regex_match(line, found, test)) return false;
    size_t depth = 0, end = line.find("if (") + 3;
    do {
        depth += line[end] == '(' ? 1 : 0;
        depth -= line[end] == ')' ? 1 : 0;
    } while (++end < line.size() && depth > 0);
    const std::string condition = line.substr(0, end) + " x";
    const std::string same = line.substr(end);
    if (!std::regex_match(condition, test)) return false;
    return std::regex_match(same.find_first_not_of(" {") == std::string::npos ? next : same, refusal);
}

}  // namespace

TEST_CASE("include_error finds forbidden includes between rooms", "[house]")
{
    CHECK(include_error("lie/so3.cpp", "dae/model.hpp") == "lie must not include dae");
    CHECK(include_error("dae/model.hpp", "studies/framework/table.hpp") == "dae must not include studies");
    CHECK(include_error("reference/motions/closed_form.cpp", "contact/surface.hpp") ==
          "reference must not include contact");
    CHECK(include_error("granular/world/world.hpp", "dae/model.hpp") == "granular must not include dae");
    CHECK(include_error("studies/program/main.cpp", "tests/support/random_motion.hpp") ==
          "studies must not include tests");
    CHECK(include_error("studies/framework/study.hpp", "studies/program/arguments.hpp") ==
          "studies/framework must not include studies/program");
    CHECK(include_error("contact/surface.hpp", "run/recording/recorder.hpp") ==
          "contact must not include run");
    CHECK(include_error("run/watch/watch.cpp", "run/single_run.hpp") == "run/watch must not include run");
    CHECK(include_error("run/single_run.cpp", "run/cosim/run_cosim.hpp") == "run must not include run/cosim");
    CHECK(include_error("run/single_run.cpp", "run/watch/watch.hpp") == "");
    CHECK(include_error("tests/lie/so3_test.cpp", "studies/program/main.cpp") ==
          "is a source file of studies, not a header");
    CHECK(include_error("dae/start.cpp", "gsl/gsl_odeiv2.h") == "dae must not include gsl");
    CHECK(include_error("dae/start.cpp", "sunlinsol/sunlinsol_klu.h") == "dae must not include sunlinsol");
    CHECK(include_error("dae/start.cpp", "../lie/so3.hpp") != "");

    CHECK(include_error("granular/running/run.cpp", "dae/force.hpp") == "granular must not include dae");
    CHECK(include_error("io/files.cpp", "lie/check.hpp") == "io must not include lie");
    CHECK(include_error("io/files.cpp", "Eigen/Core") == "io must not include Eigen");

    CHECK(include_error("python/granular_bindings/steps.cpp", "lie/state.hpp") ==
          "python/granular_bindings must not include lie");
    CHECK(include_error("python/bindings/run.cpp", "granular/world/world.hpp") ==
          "python/bindings must not include granular");

    CHECK(include_error("python/granular_bindings/steps.cpp", "python/bindings/signals.hpp") == "");
    CHECK(include_error("granular/reading/object_reader.cpp", "io/expression.hpp") == "");
    CHECK(include_error("granular/core/surfaces/meshes.hpp", "granular/mesh/mesh_file.hpp") ==
          "granular/core must not include granular/mesh");
    CHECK(include_error("granular/new/x.hpp", "granular/core/watch.hpp") ==
          "granular/new must not include granular/core");
    CHECK(include_error("granular/case/particles/fill.hpp", "granular/insertion/sizes.hpp") == "");
    CHECK(include_error("granular/case/particles/fill.hpp", "granular/case/case_file.hpp") == "");
    CHECK(include_error("granular/core/pair_law.hpp", "granular/force_models.hpp") == "");
    CHECK(include_error("dae/model.hpp", "lie/system.hpp") == "");
    CHECK(include_error("tests/studies/table_test.cpp", "studies/framework/table.hpp") == "");
    CHECK(include_error("reference/motions/closed_form.cpp", "gsl/gsl_odeiv2.h") == "");
    CHECK(include_error("reference/solvers/ida_solver.cpp", "ida/ida.h") == "");
}

TEST_CASE("the folders of a room that a folder may include do not include it", "[house]")
{
    for (const auto& [room, order] : ordered_rooms) {
        FolderOrder open = order;
        if (room == "granular") {
            REQUIRE(open.at(mutual_folders.first).erase(mutual_folders.second) == 1);
            REQUIRE(open.at(mutual_folders.second).count(mutual_folders.first) == 1);
        }
        // Removes a folder all of whose folders are removed, until there is none.
        const auto is_lowest = [&](const auto& folder) {
            return std::none_of(folder.second.begin(), folder.second.end(),
                                [&](const std::string& lower) { return open.count(lower) == 1; });
        };
        for (auto at = std::find_if(open.begin(), open.end(), is_lowest); at != open.end();
             at = std::find_if(open.begin(), open.end(), is_lowest))
            open.erase(at);
        for (const auto& [folder, lower] : open)
            FAIL_CHECK(room << "/" << folder << " is in a cycle or above one");
        for (const auto& [folder, lower] : order) {
            INFO(room << "/" << folder);
            CHECK(folders.at(room).count(folder) == 1);
            for (const std::string& other : lower) CHECK(order.count(other) == 1);
        }
    }
}

TEST_CASE("each room includes only the rooms, folders and libraries that it may", "[house]")
{
    static const std::regex include_line(R"re(^\s*#\s*include\s*["<]([^">]+)[">])re");
    int files_read = 0;
    for (const fs::path& p : paths_in_rooms()) {
        if (!is_source(p)) continue;
        ++files_read;
        std::ifstream in(root / p);
        std::string line;
        for (int number = 1; std::getline(in, line); ++number) {
            std::smatch m;
            if (!std::regex_search(line, m, include_line)) continue;
            const std::string error = include_error(p.generic_string(), m[1].str());
            if (!error.empty())
                FAIL_CHECK(p.generic_string() << ":" << number << ": " << m[1].str() << ": " << error);
        }
    }
    CHECK(files_read > 0);
}

TEST_CASE("every folder of a room is one of the documented layout", "[house]")
{
    for (const auto& [room, known] : folders) {
        for (const std::string& folder : known) {
            INFO(room << "/" << folder << " is in the layout but not in the tree");
            CHECK(fs::is_directory(root / room / folder));
        }
        for (const auto& entry : fs::recursive_directory_iterator(root / room)) {
            if (!entry.is_directory() || entry.path().filename() == "__pycache__") continue;
            const std::string folder = fs::relative(entry.path(), root / room).generic_string();
            INFO(room << "/" << folder << " is in the tree but not in the layout");
            CHECK(known.count(folder) == 1);
        }
    }
}

TEST_CASE("a folder holds at most about 20 units", "[house]")
{
    std::map<std::string, std::set<std::string>> units;
    for (const fs::path& p : paths_in_rooms())
        if (is_source(p)) units[p.parent_path().generic_string()].insert(p.stem().string());
    CHECK(units.size() > 20);
    for (const auto& [folder, stems] : units) {
        INFO(folder);
        CHECK(stems.size() <= most_units);
    }
}

TEST_CASE("comments are wrapped at 110 columns", "[house]")
{
    // Equations and tables, which are indented by four spaces, may be wider.
    static const std::regex comment(R"re(^\s*//[/<]*\s{0,3}[^\s/<].*$)re");
    const auto columns = [](const std::string& line) {
        return std::count_if(line.begin(), line.end(), [](char c) { return (c & 0xC0) != 0x80; });
    };
    for (const fs::path& p : paths_in_rooms()) {
        if (!is_source(p)) continue;
        std::ifstream in(root / p);
        std::string line;
        for (int number = 1; std::getline(in, line); ++number)
            if (columns(line) > 110 && std::regex_match(line, comment))
                FAIL_CHECK(p.generic_string() << ":" << number << ": " << columns(line) << " columns");
    }
}

TEST_CASE("no text contains the marks of an unresolved merge", "[house]")
{
    std::vector<fs::path> texts = {"README.md", "CHANGELOG.md", "CONTRIBUTING.md"};
    for (const fs::path& p : paths_in_rooms())
        if (is_source(p)) texts.push_back(p);
    for (const auto& entry : fs::recursive_directory_iterator(root / "docs"))
        if (entry.path().extension() == ".md") texts.push_back(fs::relative(entry.path(), root));
    CHECK(texts.size() > 500);
    for (const fs::path& p : texts) {
        std::ifstream in(root / p);
        std::string line;
        for (int number = 1; std::getline(in, line); ++number)
            if (line.starts_with("<<<<<<< ") || line.starts_with(">>>>>>> "))
                FAIL_CHECK(p.generic_string() << ":" << number);
    }
}

TEST_CASE("accepts_nan finds refusals that a number that is not finite passes", "[house]")
{
    CHECK(accepts_nan("    if (cosine < 1 - 1e-6)", "        lie::reject(type, \"parallel\");"));
    CHECK(accepts_nan("    if (is_new && residual.value > options.tolerance)",
                      "        throw ConstraintError(text);"));
    CHECK(accepts_nan("    if (A.determinant() < 0) o.fail(\"A\", \"a reflection\");", ""));
    CHECK(accepts_nan("    if ((a - b).norm() >= 1e-9 * b.norm()) refuse(\"b\");", ""));
    CHECK_FALSE(accepts_nan("    if (!(cosine >= 1 - 1e-6))", "        lie::reject(type, \"parallel\");"));
    CHECK_FALSE(accepts_nan("    if (residual < tolerance) return x;", "    throw NoConvergence();"));
    CHECK_FALSE(accepts_nan("    if (!error && size > max_bytes)", "        throw InvalidInput(path);"));
    CHECK_FALSE(accepts_nan("    if (cells.size() > most) fail();", ""));
}

TEST_CASE("a refusal of a deviation refuses NaN as well", "[house]")
{
    for (const fs::path& p : paths_in_rooms()) {
        const std::string extension = p.extension().string();
        if ((extension != ".cpp" && extension != ".hpp") || p.generic_string().starts_with("tests/"))
            continue;
        const std::vector<std::string> lines = lines_of(root / p);
        for (size_t k = 0; k < lines.size(); ++k)
            if (accepts_nan(lines[k], k + 1 < lines.size() ? lines[k + 1] : ""))
                FAIL_CHECK(p.generic_string()
                           << ":" << k + 1
                           << ": write !(deviation <= limit), which NaN violates: " << lines[k]);
    }
}

TEST_CASE("a folder of tests has the name of the folder that it tests", "[house]")
{
    for (const auto& [room, known] : folders) {
        const fs::path tests = root / "tests" / (room == "run" ? "running" : room);  // tests/run is a script
        if (!fs::exists(tests)) continue;
        for (const auto& entry : fs::recursive_directory_iterator(tests)) {
            if (!entry.is_directory()) continue;
            const std::string folder = fs::relative(entry.path(), tests).generic_string();
            if (folder.ends_with("__pycache__")) continue;
            INFO(tests.generic_string() << "/" << folder);
            CHECK((known.count(folder) == 1 || folder == "cones/siconos"));
        }
    }
}

TEST_CASE("there is no catch-all folder or file", "[house]")
{
    const std::set<std::string> catch_all = {"util",   "utils", "utility", "utilities",
                                             "common", "core",  "misc"};
    for (const fs::path& p : paths_in_rooms()) {
        if (p.generic_string() == "granular/core" || p.generic_string() == "tests/granular/core") continue;
        INFO(p.generic_string());
        CHECK(catch_all.count(p.stem().string()) == 0);
    }
}

TEST_CASE("the top level of the tree has the documented entries", "[house]")
{
    const std::set<std::string> always = {
        "CMakeLists.txt", "CMakePresets.json", "README.md",   "LICENSE", ".ci", "cmake",
        ".gitignore",     ".clang-format",     ".clang-tidy", "lie",     "dae", "tests",
    };
    std::set<std::string> allowed = always;
    allowed.insert(
        {"io", "contact", "granular", "reference", "run", "studies", "python", "docs", "examples"});
    allowed.insert({"CHANGELOG.md", "CITATION.cff", "CONTRIBUTING.md", "pyproject.toml"});

    const std::set<std::string> top = tracked_top_level();
    if (top.empty()) {
        WARN("skipped: not a git repository");
        return;
    }
    for (const std::string& name : top) {
        INFO(name << " is tracked but not allowed at the top level");
        CHECK(allowed.count(name) == 1);
    }
    for (const std::string& name : always) {
        INFO(name << " is missing");
        CHECK(top.count(name) == 1);
    }
}
