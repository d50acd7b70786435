// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/resumable.hpp"

#include "io/archive.hpp"
#include "io/error.hpp"
#include "io/files.hpp"
#include "io/json.hpp"
#include "tests/support/paths.hpp"

#include <catch2/catch.hpp>

#include <csignal>
#include <filesystem>
#include <functional>
#include <memory>
#include <stdexcept>

#include <unistd.h>

using namespace hilda;
namespace fs = std::filesystem;

namespace {

/// Adds the numbers 1, 2, ..., and writes each of them to a file.
class Sum final : public io::Resumable {
public:
    using Resumable::execute;

    Sum(const io::ResumableOptions& options, int end) : Resumable(options), end_of_sum(end) {}

    std::function<void(int number)> before_step = [](int /*number*/) {};
    int number = 0, sum = 0, resumed_at = 0, saves = 0;
    bool extends = false;
    std::string calls;  ///< the first letters of the functions, in the order of the calls

private:
    bool read() override
    {
        calls += 'r';
        extends = fs::exists(path("summary.json")) && !files.exist();
        return true;
    }
    void restore(const std::string& bytes, const std::string& file) override
    {
        io::Archive a(bytes, file);
        transfer(a);
        a.end();
        if (number > end_of_sum) throw io::UsageError("the end has been passed");
        resumed_at = number;
    }
    void check() override { calls += 'k'; }
    void clear() override
    {
        calls += 'l';
        std::remove(path("numbers").c_str());
    }
    void open() override
    {
        calls += 'o';
        output = std::make_unique<io::OutputFile>(path("numbers"), written, resumed);
        if (resumed && extends) extend();
    }
    bool at_end() const override { return number == end_of_sum; }
    bool next_step() override
    {
        before_step(number + 1);
        if (io::Interrupt::caught() != 0) return false;  // as an adaptive step
        sum += ++number;
        output->buffer += std::to_string(number) + '\n';
        return true;
    }
    void end() override { calls += 'e'; }
    void close() override
    {
        calls += 'c';
        output->flush();
    }
    std::string summary() override
    {
        calls += 's';
        return io::Json({{"status", status}, {"message", message}, {"code", code}, {"sum", sum}}).text();
    }
    void report() override
    {
        calls += 'p';
        CHECK(fs::exists(path("summary.json")));
    }
    double time() const override { return number; }
    void show(io::ProgressLine& /*on*/, Clock::time_point /*now*/) const override {}
    void before_save() override { output->sync(); }
    void write(const io::Append& append) override
    {
        ++saves;
        written = output->size();
        io::Archive a;
        transfer(a);
        append(a.bytes());
    }
    void transfer(io::Archive& a) { a.value(number), a.value(sum), a.value(written); }

    const int end_of_sum;
    std::uint64_t written = 0;
    std::unique_ptr<io::OutputFile> output;
};

struct Directory {
    Directory() : path(fs::temp_directory_path() / ("hilda_resumable_test_" + std::to_string(getpid())))
    {
        fs::remove_all(path);
    }
    ~Directory() { fs::remove_all(path); }

    io::ResumableOptions options(bool resume = false, double checkpoint = 0) const
    {
        return {.directory = path, .checkpoint = checkpoint, .resume = resume, .quiet = true};
    }
    std::string text(const std::string& file) const { return io::read_file(path / file, 1000); }
    bool has(const std::string& file) const { return fs::exists(path / file); }

    const fs::path path;
};

const std::string ten = "1\n2\n3\n4\n5\n6\n7\n8\n9\n10\n";

}  // namespace

TEST_CASE("a complete run leaves its outputs, its summary, and a checkpoint for a later end",
          "[io][resumable]")
{
    const Directory d;
    Sum run(d.options(), 10);
    CHECK(run.execute() == 0);
    CHECK(run.calls == "rkloecsp");
    CHECK(d.text("numbers") == ten);
    CHECK(d.text("summary.json").find(R"("sum": 55)") != std::string::npos);
    CHECK(d.text("summary.json").find(R"("status": "ok")") != std::string::npos);
    CHECK(d.has("checkpoint.end"));
    CHECK_FALSE(d.has("checkpoint"));
}

TEST_CASE("an interrupted run is continued at its step, with the same outputs", "[io][resumable]")
{
    const Directory d;
    {
        const io::Interrupt interrupt;
        Sum run(d.options(), 10);
        run.before_step = [](int n) {
            if (n == 4) std::raise(SIGTERM);
        };
        CHECK(run.execute() == 128 + SIGTERM);
        CHECK(run.number == 3);
        CHECK(run.calls == "rklocsp");  // without its end
        CHECK(d.text("summary.json").find(R"("status": "interrupted")") != std::string::npos);
        CHECK(d.has("checkpoint"));
        CHECK_FALSE(d.has("checkpoint.end"));
        io::Interrupt::forget();
    }
    Sum again(d.options(true), 10);
    CHECK(again.execute() == 0);
    CHECK(again.resumed_at == 3);
    CHECK(again.calls == "rkoecsp");
    CHECK(again.sum == 55);
    CHECK(d.text("numbers") == ten);
    CHECK(d.has("checkpoint.end"));
    CHECK_FALSE(d.has("checkpoint"));
}

TEST_CASE("a numerical failure is in the summary, without a checkpoint of the end", "[io][resumable]")
{
    const Directory d;
    Sum run(d.options(), 10);
    run.before_step = [](int n) {
        if (n == 4) throw io::NumericalFailure("planned", "the test asked for it");
    };
    CHECK(run.execute() == io::exit_code::numerical_failure);
    CHECK(d.text("numbers") == "1\n2\n3\n");
    CHECK(d.text("summary.json").find(R"("message": "the test asked for it")") != std::string::npos);
    CHECK_FALSE(d.has("checkpoint.end"));
}

TEST_CASE("a run that ends by another exception continues from the checkpoint that was due last",
          "[io][resumable]")
{
    const Directory d;
    Sum run(d.options(false, 1e-9), 10);  // due after each step
    run.before_step = [](int n) {
        if (n == 8) throw std::runtime_error("killed");
    };
    CHECK_THROWS_AS(run.execute(), std::runtime_error);
    CHECK(run.saves == 7);
    CHECK_FALSE(d.has("summary.json"));
    CHECK_THROWS_AS(Sum(d.options(true), 10), io::IoError);  // the first one holds the lock
}

TEST_CASE("the checkpoint before replaces a damaged one", "[io][resumable]")
{
    const Directory d;
    {
        Sum run(d.options(false, 1e-9), 10);
        run.before_step = [](int n) {
            if (n == 8) throw std::runtime_error("killed");
        };
        CHECK_THROWS(run.execute());
    }
    io::write_file(d.path / "checkpoint", "x");
    const std::string good = d.text("checkpoint.1");
    Sum again(d.options(true, 1e-9), 10);
    again.before_step = [&](int n) {  // the damaged one does not replace the one before
        if (n == 8) CHECK(d.text("checkpoint.1") == good);
    };
    CHECK(again.execute() == 0);
    CHECK(again.resumed_at == 6);
    CHECK(again.saves == 3 + 1);  // after 7, 8 and 9, and that of the end
    CHECK(d.text("numbers") == ten);
}

TEST_CASE("a later end extends a complete run, which is unfinished from then on", "[io][resumable]")
{
    const Directory d;
    CHECK(Sum(d.options(), 4).execute() == 0);
    {
        Sum longer(d.options(true), 10);
        longer.before_step = [&](int n) {
            CHECK_FALSE(d.has("summary.json"));
            if (n == 7) throw std::runtime_error("killed");
        };
        CHECK_THROWS(longer.execute());
        CHECK(longer.resumed_at == 4);
    }
    CHECK(d.has("checkpoint"));
    {
        Sum again(d.options(true), 10);
        CHECK(again.execute() == 0);
        CHECK(again.resumed_at == 4);
        CHECK_FALSE(again.extends);
    }
    CHECK(d.text("numbers") == ten);
    CHECK(d.text("summary.json").find(R"("sum": 55)") != std::string::npos);

    // What restore() refuses leaves the directory as it is.
    CHECK_THROWS_AS(Sum(d.options(true), 8).execute(), io::UsageError);
    CHECK(d.text("numbers") == ten);
}

TEST_CASE("a new run removes the summary and the checkpoints of the one before", "[io][resumable]")
{
    const Directory d;
    CHECK(Sum(d.options(), 10).execute() == 0);
    Sum other(d.options(), 3);
    other.before_step = [&](int /*number*/) {
        CHECK_FALSE(d.has("summary.json"));
        CHECK_FALSE(d.has("checkpoint.end"));
    };
    CHECK(other.execute() == 0);
    CHECK(d.text("numbers") == "1\n2\n3\n");
}

TEST_CASE("a run that is to be resumed and has no checkpoint starts from the beginning", "[io][resumable]")
{
    const Directory d;
    Sum run(d.options(true), 10);
    CHECK(run.execute() == 0);
    CHECK(run.calls == "rkloecsp");
    CHECK(d.text("numbers") == ten);
}
