// SPDX-License-Identifier: GPL-3.0-or-later
/// Files of an output directory that are links to files elsewhere: no command writes through them.

#include "tests/support/paths.hpp"
#include "tests/support/program/program.hpp"

#include <catch2/catch.hpp>

#include <array>
#include <vector>

using namespace hilda::tests;
using Catch::Matchers::Contains;

namespace {

/// The files in a directory and its folders, relative to it
std::vector<fs::path> files_in(const fs::path& directory)
{
    std::vector<fs::path> all;
    for (const auto& entry : fs::recursive_directory_iterator(directory))
        if (entry.is_regular_file()) all.push_back(fs::relative(entry.path(), directory));
    return all;
}

void replace_by_link(const fs::path& file, const fs::path& target)
{
    fs::remove(file);
    fs::create_symlink(target, file);
}

}  // namespace

TEST_CASE("no command writes through a link in its output directory", "[studies][program]")
{
    const Scratch in;
    write(in / "data.csv", "t,bar_2.rx\n0,0\n0.01,0\n0.02,0\n");
    const std::vector<std::vector<std::string>> commands = {
        {"run", "double_pendulum", "--end", "0.02", "--vtk", "0.01", "--log-steps", "--checkpoint", "1e-9"},
        {"run", "double_pendulum", "--end", "0.02", "--format", "hdf5"},
        {"kinematics", "slider_crank", "--end", "0.02", "--vtk", "0.01"},
        {"fit", "double_pendulum", "--data", "data.csv", "--parameter", "/bodies/0/mass",
         "--max-fit-iterations", "1", "--no-plot"},
        {"study", "energy", "--problem", "double_pendulum", "--integrator", "rA-half-1", "--end", "0.02",
         "--no-plot"}};
    for (std::vector<std::string> command : commands) {
        fs::remove_all(in / "out");
        command.insert(command.end(), {"--quiet", "--output", "out"});
        call(in, command);
        const std::vector<fs::path> files = files_in(in / "out");
        REQUIRE(files.size() >= 2);
        command.emplace_back("--force");
        for (const char* more : {"checkpoint", "checkpoint.new.tmp", "summary.json.tmp", "run.h5.tmp",
                                 "run.h5.trajectory.0.rows", "study.part"})
            for (const bool all : {false, true}) {
                write(in / "precious", "precious");
                for (const fs::path& file : files) replace_by_link(in / "out" / file, in / "precious");
                if (all) replace_by_link(in / "out" / more, in / "precious");
                const Ended ended = call(in, command);
                INFO(command[0] << ' ' << more << ": " << ended.err);
                CHECK(read(in / "precious") == "precious");
            }
    }
    CHECK(fs::is_regular_file(in / "out/study.csv"));
}

TEST_CASE("of commands that start at once with one output directory one writes its result",
          "[studies][program]")
{
    const Scratch in;
    write(in / "data.csv", "t,bar_1.rx\n0,2\n0.01,1.9\n0.02,1.8\n");
    const std::vector<std::vector<std::string>> commands = {
        {"fit", "double_pendulum", "--data", (in / "data.csv").string(), "--parameter", "/bodies/0/mass",
         "--max-fit-iterations", "2", "--no-plot"},
        {"run", "double_pendulum", "--end", "0.1"},
        {"kinematics", "slider_crank", "--end", "0.1"},
        {"study", "energy", "--problem", "double_pendulum", "--integrator", "rA-half-1", "--end", "0.1",
         "--no-plot"}};
    for (std::vector<std::string> command : commands) {
        fs::remove_all(in / "out");
        command.insert(command.end(), {"--quiet", "--output", (in / "out").string()});
        const std::array<Scratch, 3> folders;  // for their messages
        std::vector<Program> all;
        for (const Scratch& folder : folders) all.emplace_back(folder, command);
        int written = 0;
        for (const Program& one : all) {
            const Ended ended = one.wait();
            INFO(command[0] << ": " << ended.err);
            const bool refused = ended.code == 2 || ended.code == 5;
            written += refused ? 0 : 1;
            if (refused)
                CHECK_THAT(ended.err,
                           Contains("out: is not empty; ") || Contains("another process writes to it"));
        }
        INFO(command[0]);
        CHECK(written == 1);
    }
}

TEST_CASE("a table that is removed while a run writes it ends the run with an error", "[studies][program]")
{
    const Scratch in;
    for (const bool is_hdf5 : {false, true}) {
        fs::remove_all(in / "out");
        const fs::path table = in / (is_hdf5 ? "out/run.h5.trajectory.0.rows" : "out/trajectory.csv");
        const Program run(in, {"run", "double_pendulum", "--end", "60", "--interval", "1e-3", "--format",
                               is_hdf5 ? "hdf5" : "csv", "--quiet", "--output", "out"});
        REQUIRE(appears(table));
        fs::remove(table);
        const Ended ended = run.wait();
        INFO(ended.err);
        CHECK(ended.code == 5);
        CHECK_THAT(ended.err, Contains("was removed or replaced by another program while it was written"));
        CHECK_FALSE(fs::exists(in / "out/summary.json"));
    }
}

TEST_CASE("frames are not written to a folder that is a link", "[studies][program]")
{
    const Scratch in;
    fs::create_directories(in / "out");
    fs::create_directories(in / "elsewhere");
    fs::create_directory_symlink(in / "elsewhere", in / "out/vtk");
    const Ended ended =
        call(in, {"run", "double_pendulum", "--end", "0.02", "--vtk", "0.01", "--force", "--output", "out"});
    CHECK(ended.code == 5);
    CHECK_THAT(ended.err, Contains("out/vtk: is a symbolic link; remove it, or give another --output"));
    CHECK(fs::is_empty(in / "elsewhere"));
}

TEST_CASE("pages and figures are not written through a link", "[studies][program]")
{
    const Scratch in;
    REQUIRE(call(in, {"run", "double_pendulum", "--end", "0.02", "--quiet", "--output", "out"}).code == 0);
    write(in / "precious", "<!DOCTYPE html>precious");
    for (const char* name : {"trajectory.png", "trajectory.png.new", "view.html", "view.html.new"})
        replace_by_link(in / "out" / name, in / "precious");
    call(in, {"plot", "out"});
    call(in, {"view", "out"});
    CHECK(read(in / "precious") == "<!DOCTYPE html>precious");
}

TEST_CASE("a model names files below its folder unless --allow-paths is given", "[studies][program]")
{
    const Scratch in;
    fs::create_directories(in / "models/meshes");
    for (const char* copy : {"mesh.obj", "models/meshes/mesh.obj"})
        fs::copy_file(fs::path(test_data) / "models/contacts/meshes/stone.obj", in / copy);
    fs::create_symlink("../mesh.obj", in / "models/link.obj");
    const auto model = [&](const std::string& file) {
        write(
            in / "models/a.json",
            R"({"hilda_model": 1, "name": "a", "bodies": [{"name": "b", "mass": 1, "inertia": [1, 1, 1], "r": [0, 0, 0]}], "contacts": [
                  {"body_i": "b", "body_j": "ground", "surface_i": {"type": "mesh", "file": ")" +
                file + R"("}, "surface_j": {"type": "plane", "position": [0, 0, -9]},
                  "normal": {"type": "hooke", "stiffness": 1e6}}]})");
    };
    for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
             {"check", "models/a.json"},
             {"run", "models/a.json", "--end", "0.001", "--output", "out", "--force"},
             {"study", "energy", "--problem", "models/a.json", "--end", "0.001", "--integrator", "rA-half-1",
              "--steps", "1e-3", "--no-plot", "--output", "out", "--force"}}) {
        INFO(command[0]);
        model("meshes/mesh.obj");
        const Ended below = call(in, command);
        INFO(below.err);
        CHECK(below.code == 0);
        for (const std::string& file :
             {std::string("../mesh.obj"), (in / "mesh.obj").string(), std::string("link.obj"),
              std::string("/etc/passwd"), std::string("../none.obj")}) {
            model(file);
            const Ended refused = call(in, command);
            INFO(file << ": " << refused.err);
            CHECK(refused.code == 3);
            CHECK_THAT(refused.err,
                       Contains("/file): file must be below the folder of the file that names it, ") &&
                           Contains("models, got \"" + file + "\"; --allow-paths accepts it"));
        }
        model("../mesh.obj");
        std::vector<std::string> accepted = command;
        accepted.emplace_back("--allow-paths");
        CHECK(call(in, accepted).code == 0);
    }
}

TEST_CASE("a name in a file does not choose the folder of the output", "[studies][program]")
{
    const Scratch in;
    fs::create_directories(in / "below");
    std::string text = pendulum();
    const std::string name = R"("name": "pendulum")";
    REQUIRE(text.find(name) != std::string::npos);
    write(in / "below/a.json", text.replace(text.find(name), name.size(), R"("name": "../away")"));
    const Ended exported = call(in, {"export", "below/a.json"});
    CHECK(exported.code == 3);
    CHECK_THAT(exported.err,
               Contains(R"(the name of the model, "../away", contains a /; --output gives the name)"));
    CHECK(call(in, {"export", "below/a.json", "--output", "a.urdf"}).code == 0);

    fs::copy(fs::path(source_dir) / "examples/cosim/strike", in / "strike", fs::copy_options::recursive);
    for (const char* wrong : {"../../away", "/tmp/away", "..", "a/b"}) {
        const Ended cosim = call(in, {"cosim", "strike/strike.json", "--set", std::string("/name=") + wrong});
        INFO(wrong);
        CHECK(cosim.code == 3);
        CHECK_THAT(cosim.err, Contains("name must be the name of a directory, without /, got"));
    }
    for (const char* key : {"model", "case"}) {
        const Ended cosim =
            call(in, {"cosim", "strike/strike.json", "--set", std::string("/") + key + "=../pendulum.json"});
        CHECK(cosim.code == 3);
        CHECK_THAT(cosim.err, Contains("must be below the folder of the file that names it"));
    }
}

TEST_CASE("names in files cannot act on the terminal", "[studies][program]")
{
    const Scratch in;
    const auto err = [&](const std::string& name) {
        write(
            in / "a.json",
            R"({"hilda_model": 1, "name": ")" + name +
                R"(", "bodies": [{"name": "b", "mass": 1, "inertia": [1, 1, 1], "r": [0, 0, 0]}], "joints": 1})");
        const Ended ended = call(in, {"check", "a.json"});
        CHECK(ended.code == 3);
        CHECK(ended.out.empty());
        return ended.err;
    };
    CHECK_THAT(err("a\\u009b31m"),
               Contains(R"(must be a name without control characters, got "a\u009b31m")"));
    CHECK_THAT(err("a\\u202egnp"), Contains(R"(got "a\u202egnp")"));
    CHECK_THAT(err("a\\u007f"), Contains(R"(got "a\u007f")"));
    CHECK_THAT(err("a\\u0000b"), Contains(R"(got "a\u0000b")"));
    write(
        in / "key.json",
        R"({"hilda_model": 1, "name": "a", "bodies": [{"name": "b", "mass": 1, "inertia": [1, 1, 1], "r": [0, 0, 0]}], "\u0000\u009b\u202e": 1})");
    CHECK_THAT(call(in, {"check", "key.json"}).err,
               Contains(R"(unknown key "\u0000\u009b\u202e"; allowed: )"));
}
