// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/files.hpp"

#include "io/program.hpp"

#include <catch2/catch.hpp>

#include <sys/resource.h>
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

    SECTION("through a symbolic link")
    {
        fs::create_symlink("a", in.path / "link");
        io::write_file(in.file("link"), "new");
        CHECK(fs::is_symlink(in.path / "link"));
        CHECK(io::read_file(in.file("a"), 10) == "new");
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
