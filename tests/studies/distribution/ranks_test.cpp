// SPDX-License-Identifier: GPL-3.0-or-later
/// Studies under mpirun.
#include "tests/studies/csv.hpp"
#include "tests/studies/distribution/divided_studies.hpp"
#include "tests/studies/refused.hpp"

#include <catch2/catch.hpp>

using namespace hilda::tests;
using Catch::Matchers::Contains;

namespace {

/// A call under mpirun. `end_at` as HILDA_END_AT of tests/support/end_at_write.cpp.
Ended mpirun(const Scratch& in, int ranks, const std::vector<std::string>& arguments,
             const std::string& end_at = "", const std::string& more = "")
{
    std::string command = "cd '" + in.path.string() + "' && ";
    // Open MPI leaks memory.
    command += "HILDA_END_AT='" + end_at + "' ASAN_OPTIONS=detect_leaks=0 ";
    command += "timeout 120 mpirun --allow-run-as-root --oversubscribe " + more + " -n " +
               std::to_string(ranks) + " '" + (end_at.empty() ? hilda_program : hilda_ending_program) + "'";
    for (const std::string& word : arguments) command += " '" + word + "'";
    const int status = std::system((command + " > .out 2> .err < /dev/null").c_str());
    return {.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
            .out = read(in / ".out"),
            .err = read(in / ".err")};
}

/// Whether mpirun starts processes on this machine. Containers without a network interface forbid it.
bool mpirun_works()
{
    static const bool works =
        std::system("timeout 60 mpirun --allow-run-as-root --oversubscribe -n 2 true > /dev/null 2>&1") == 0;
    if (!works) WARN("left out: mpirun starts no processes on this machine");
    return works;
}

std::vector<CsvRow> without_times(const fs::path& file)
{
    std::vector<CsvRow> rows = csv(file);
    for (CsvRow& row : rows) row.erase("cpu_seconds");
    return rows;
}

/// Requires that run 3 of the sweep alone is lost, and that --resume computes it.
void check_third_run_lost(const Scratch& in)
{
    const std::vector<CsvRow> rows = without_times(in / "cut/study.csv");
    REQUIRE(rows.size() == 5);
    for (size_t k = 0; k < 5; ++k) {
        CAPTURE(k);
        CHECK(rows[k].at("status") == (k == 2 ? "killed" : "ok"));
        CHECK(rows[k].at("observable_end").empty() == (k == 2));
    }
    CHECK_THAT(read(in / "cut/study.json"), Contains("killed"));
    const std::vector<std::string> again = with(swing, {"--output", "cut", "--resume"});
    Limits other_program;  // the one that computed the other runs
    other_program.end_at = {SIGKILL, 1, "no such file"};
    const Ended resumed = call(in, again, other_program);
    CAPTURE(resumed.err);
    CHECK(resumed.code == 0);
    CHECK_THAT(resumed.err, Contains("4 finished jobs are read from cut"));
    REQUIRE(call(in, with(swing, {"--quiet", "--output", "whole"})).code == 0);
    CHECK(without_times(in / "cut/study.csv") == without_times(in / "whole/study.csv"));
    CHECK(read(in / "cut/runs/0003/trajectory.csv") == read(in / "whole/runs/0003/trajectory.csv"));
}

}  // namespace

TEST_CASE("a study under mpirun gives the bytes of the study for any number of ranks", "[studies][ranks]")
{
    if (!mpirun_works()) return;
    const Scratch in;
    REQUIRE(call(in, with(incline, {"--quiet", "--output", "whole"})).code == 0);
    const std::string table = read(in / "whole/study.csv");
    for (const int ranks : {1, 2, 3}) {
        CAPTURE(ranks);
        const Ended ended = mpirun(in, ranks, with(incline, {"--output", "of-" + std::to_string(ranks)}));
        CAPTURE(ended.err);
        CHECK(ended.code == 0);
        CHECK(read(in / ("of-" + std::to_string(ranks)) / "study.csv") == table);
        CHECK(ended.out.find("written to") == ended.out.rfind("written to"));  // by rank 0 alone
        CHECK_FALSE(fs::exists(in / ("of-" + std::to_string(ranks)) / "study.part"));
    }
    // several processes on each rank, and a shard
    CHECK(mpirun(in, 2, with(incline, {"--quiet", "--jobs", "2", "--output", "jobs"})).code == 0);
    CHECK(read(in / "jobs/study.csv") == table);
    CHECK(mpirun(in, 2, with(incline, {"--quiet", "--shard", "1/2", "--output", "s1"})).code == 0);
    CHECK(call(in, with(incline, {"--quiet", "--shard", "2/2", "--output", "s2"})).code == 0);
    CHECK(call(in, {"collect", "s1", "s2", "--quiet", "--no-plot", "--output", "shards"}).code == 0);
    CHECK(read(in / "shards/study.csv") == table);
}

TEST_CASE("a validation of grains under mpirun gives its bytes (long)", "[studies][ranks]")
{
    if (!mpirun_works()) return;
    const Scratch in;
    const std::vector<std::string> brick = {"study", "granular-brick", "--no-plot", "--quiet", "--output"};
    REQUIRE(call(in, with(brick, {"whole"})).code == 0);
    const Ended ended = mpirun(in, 3, with(brick, {"ranks"}));
    CAPTURE(ended.err);
    CHECK(ended.code == 0);
    for (const char* file : {"study.csv", "motion.csv"})
        CHECK(read(in / "ranks" / file) == read(in / "whole" / file));
}

TEST_CASE("a run under mpirun whose process is killed is a row; the other runs are computed",
          "[studies][ranks]")
{
    if (!mpirun_works()) return;
    const Scratch in;
    write(in / "swing.json", pendulum());
    const Ended ended = mpirun(in, GENERATE(2, 3), with(swing, {"--output", "cut"}),
                               std::to_string(SIGKILL) + " 1 runs/0003/model.json.tmp");
    CAPTURE(ended.err);
    CHECK(ended.code == 4);
    CHECK_THAT(ended.err,
               Contains("hilda: error[killed]: study sweep: 1 run was lost: the process of the run "
                        "was ended by signal 9 (Killed)"));
    check_third_run_lost(in);
}

TEST_CASE("a rank that is killed costs its run with mpirun --enable-recovery", "[studies][ranks]")
{
    if (!mpirun_works()) return;
    const Scratch in;
    write(in / "swing.json", pendulum());
    // The process of the run ends its parent process, the rank. Rank 0 may compute this run: then the study
    // ends, and is repeated.
    Ended ended;
    for (int k = 0; k < 30; ++k) {
        ended = mpirun(in, 4, with(swing, {"--output", "cut", "--force"}),
                       std::to_string(-SIGKILL) + " 1 runs/0003/model.json.tmp", "--enable-recovery");
        if (fs::exists(in / "cut/study.csv")) break;
        CHECK(fs::exists(in / "cut/study.part"));
    }
    CAPTURE(ended.err);
    REQUIRE(fs::exists(in / "cut/study.csv"));
    CHECK_THAT(ended.err, Contains("1 run was lost: rank ") && Contains(" of mpirun has ended"));
    check_third_run_lost(in);
}

TEST_CASE("one rank reports an error", "[studies][ranks]")
{
    if (!mpirun_works()) return;
    const Scratch in;
    const auto count = [](const std::string& text, const std::string& part) {
        size_t n = 0;
        for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
        return n;
    };
    for (const auto& [arguments, message] :
         {std::pair(std::vector<std::string>{"study", "timing"}, "study timing: mpirun is for compare, "),
          {{"study", "incline-sweap"}, "did you mean 'incline-sweep'?"},
          {{"study", "incline-sweep", "--jobs", "many"}, "--jobs: must be a whole number"},
          {{"study", "sweep", "--sweep", "/gravity/7=1,2"}, "/gravity/7"}}) {
        const Ended ended = mpirun(in, 3, arguments);
        CAPTURE(arguments, ended.err);
        CHECK((ended.code == 2 || ended.code == 3));
        CHECK_THAT(ended.err, Contains(message));
        CHECK(count(ended.err, "hilda: error: ") == 1);
    }
}
