// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files.hpp"

#include "io/program.hpp"

#include <catch2/catch.hpp>

#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>

using namespace hilda;
namespace fs = std::filesystem;
using Catch::Contains;

namespace {

/// A new directory, which is removed at the end of the test
struct Directory {
    fs::path path = fs::temp_directory_path() / ("hilda-io-" + std::to_string(getpid()));
    Directory() { fs::create_directories(path); }
    ~Directory() { fs::remove_all(path); }
    std::string file(const std::string& name) const { return (path / name).string(); }
};

std::vector<std::string> names(const fs::path& directory)
{
    std::vector<std::string> all;
    for (const auto& entry : fs::directory_iterator(directory)) all.push_back(entry.path().filename());
    std::sort(all.begin(), all.end());
    return all;
}

}  // namespace

TEST_CASE("a file is written as a whole and replaces the old one", "[io][files]")
{
    const Directory in;
    const std::string text("a\0b\n", 4);
    io::write_file(in.file("a"), "old");
    io::write_file(in.file("a"), text);
    CHECK(io::read_file(in.file("a"), 4) == text);
    CHECK(names(in.path) == std::vector<std::string>{"a"});

    SECTION("through a symbolic link that the user names")
    {
        fs::create_symlink("a", in.path / "link");
        io::write_named_file(in.file("link"), "new");
        CHECK(fs::is_symlink(in.path / "link"));
        CHECK(io::read_file(in.file("a"), 10) == "new");
    }
    SECTION("not through a symbolic link in an output directory")
    {
        fs::create_symlink("a", in.path / "link");
        io::write_file(in.file("link"), "new");
        CHECK_FALSE(fs::is_symlink(in.path / "link"));
        CHECK(io::read_file(in.file("link"), 10) == "new");
        CHECK(io::read_file(in.file("a"), 10) == text);
    }
    SECTION("renamed over another one")
    {
        io::write_file(in.file("b"), "of b");
        io::rename_file(in.file("b"), in.file("a"));
        CHECK(io::read_file(in.file("a"), 10) == "of b");
        CHECK(names(in.path) == std::vector<std::string>{"a"});
    }
}

TEST_CASE("a link with the name of the temporary file is not followed", "[io][files]")
{
    const Directory in;
    io::write_file(in.file("other"), "of another program");
    fs::create_symlink("other", in.path / "a.tmp");
    io::write_file(in.file("a"), "new");
    CHECK(io::read_file(in.file("other"), 100) == "of another program");
    CHECK(io::read_file(in.file("a"), 10) == "new");
    CHECK(names(in.path) == std::vector<std::string>{"a", "other"});

    std::ofstream(in.file("a.tmp")) << "left by a process that was killed";
    io::write_file(in.file("a"), "newer");
    CHECK(io::read_file(in.file("a"), 10) == "newer");
    CHECK(names(in.path) == std::vector<std::string>{"a", "other"});
}

TEST_CASE("a file that cannot be written completely keeps its content, and nothing else remains",
          "[io][files]")
{
    const Directory in;
    io::write_file(in.file("a"), "old");
    // With a limit of the file size, write() fails with EFBIG, as it fails with ENOSPC on a full disk.
    rlimit unlimited{};
    REQUIRE(getrlimit(RLIMIT_FSIZE, &unlimited) == 0);
    rlimit limited = unlimited;
    limited.rlim_cur = 100;
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    REQUIRE(setrlimit(RLIMIT_FSIZE, &limited) == 0);
    bool failed = false;
    try {
        io::write_file(in.file("a"), std::string(1000, 'x'));
    } catch (const io::IoError&) {
        failed = true;
    }
    setrlimit(RLIMIT_FSIZE, &unlimited);
    std::signal(SIGXFSZ, handler);
    CHECK(failed);
    CHECK(io::read_file(in.file("a"), 10) == "old");
    CHECK(names(in.path) == std::vector<std::string>{"a"});
}

TEST_CASE("an error of a file names its path and the reason", "[io][files]")
{
    const Directory in;
    const auto error = [](const auto& action) -> std::string {
        try {
            action();
        } catch (const io::IoError& e) {
            CHECK(e.code == io::exit_code::input_output);
            return e.what();
        }
        return "no error";
    };
    const std::string none = in.file("none/a");
    CHECK(error([&] { io::write_file(none, "x"); }) ==
          none + ": cannot be written: No such file or directory");
    CHECK(error([&] { io::read_file(none, 1); }) == none + ": does not exist");
    CHECK(error([&] { io::read_file(in.path.string(), 1); }) == in.path.string() + ": is not a regular file");
    io::write_file(in.file("long"), "12345");
    CHECK(error([&] { io::read_file(in.file("long"), 4); }) ==
          in.file("long") + ": is larger than 4 bytes, got 5");
    CHECK_THAT(error([&] { io::make_directory(in.file("long/x")); }),
               Contains("cannot be created: Not a directory"));
    CHECK_THAT(error([&] { io::is_missing_or_empty(in.file("long")); }), Contains("is not a directory"));
    CHECK(io::is_missing_or_empty(in.file("none")));
    CHECK_FALSE(io::is_missing_or_empty(in.path.string()));
}

TEST_CASE("an output file that is removed or replaced while it is written is an error", "[io][files]")
{
    const Directory in;
    const std::string path = in.file("rows.csv");
    for (const bool replaced : {false, true})
        for (const bool synchronises : {false, true}) {
            io::OutputFile file(path);
            file.buffer += "t,x\n";
            CHECK_NOTHROW(file.sync());
            CHECK_NOTHROW(file.finish());
            fs::remove(path);
            if (replaced) std::ofstream(path) << "t,x\n";
            const std::string message =
                path + ": was removed or replaced by another program while it was written; its rows are lost";
            if (synchronises)
                CHECK_THROWS_WITH(file.sync(), message);
            else
                CHECK_THROWS_WITH(file.finish(), message);
        }
}

TEST_CASE("an output file is not written through a link, nor to a device or a pipe", "[io][files]")
{
    const Directory in;
    io::write_file(in.file("other"), "of another program");
    fs::create_symlink("other", in.path / "link");
    fs::create_symlink("none", in.path / "nowhere");
    REQUIRE(mkfifo(in.file("pipe").c_str(), 0600) == 0);
    for (const bool resume : {false, true}) {
        const std::string remedy = "; remove it, or give another --output";
        CHECK_THROWS_WITH(io::OutputFile(in.file("link"), 0, resume),
                          in.file("link") + ": is a symbolic link" + remedy);
        CHECK_THROWS_AS(io::OutputFile(in.file("nowhere"), 0, resume), io::IoError);
        CHECK_THROWS_AS(io::OutputFile(in.file("pipe"), 0, resume), io::IoError);
        CHECK_THROWS_AS(io::OutputFile(in.path.string(), 0, resume), io::IoError);
    }
    CHECK_THROWS_WITH(io::OutputFile("/dev/null"),
                      "/dev/null: is not a regular file; remove it, or give another --output");
    CHECK(io::read_file(in.file("other"), 100) == "of another program");
    CHECK_FALSE(fs::exists(in.path / "none"));

    fs::create_directory(in.path / "elsewhere");
    fs::create_symlink("elsewhere", in.path / "vtk");
    CHECK_THROWS_WITH(io::make_folder_in(in.path.string(), "vtk"),
                      in.file("vtk") + ": is a symbolic link; remove it, or give another --output");
    io::make_folder_in(in.path.string(), "frames");
    CHECK(fs::is_directory(in.path / "frames"));
}

TEST_CASE("a lock finds the files that another process has written since the directory was checked",
          "[io][files]")
{
    const Directory in;
    const std::string directory = in.file("run");
    io::OutputLock late(directory, false, io::force_overwrites), with_force(directory, true);
    {
        io::OutputLock first(directory, false);
        first.create();
        io::write_file(directory + "/fit.json", "{}");
    }
    CHECK_THROWS_WITH(late.create(), directory + ": is not empty; --force overwrites it");
    CHECK_THROWS_AS(io::OutputLock(directory, false), io::UsageError);
    CHECK_NOTHROW(with_force.create());
}

TEST_CASE("an output directory is locked until the lock ends", "[io][files]")
{
    const Directory in;
    const std::string directory = in.file("new/run");
    {
        io::OutputLock first(directory);  // does not exist yet
        io::OutputLock second(directory);
        CHECK_FALSE(std::filesystem::exists(directory));
        first.create();
        CHECK(std::filesystem::is_empty(directory));
        first.create();
        CHECK_THROWS_WITH(second.create(), directory +
                                               ": another process writes to it; wait for its end, or "
                                               "give another --output");
        CHECK_THROWS_AS(io::OutputLock(directory), io::IoError);
    }
    CHECK_NOTHROW(io::OutputLock(directory));
}

TEST_CASE("an output file is continued at a given length", "[io][files]")
{
    const Directory in;
    const std::string path = in.file("rows.csv");
    {
        io::OutputFile file(path);
        file.buffer += "t,x\n0,1\n";
        CHECK(file.size() == 8);
        file.flush();
        file.buffer += "1,2\n";
        file.sync();
        CHECK(file.size() == 12);
        file.buffer += "not written";
    }
    CHECK(io::read_file(path, 100) == "t,x\n0,1\n1,2\n");
    {
        io::OutputFile file(path, 8, true);
        file.buffer += "1,3\n";
        file.flush();
    }
    CHECK(io::read_file(path, 100) == "t,x\n0,1\n1,3\n");
    CHECK_THROWS_WITH(io::OutputFile(path, 13, true),
                      path + ": is shorter than the checkpoint states: 12 bytes, not 13");
}
