// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/repeating/reproduce.hpp"

#include "io/error.hpp"
#include "io/files.hpp"
#include "io/json_source.hpp"
#include "io/message.hpp"
#include "io/program.hpp"
#include "io/progress.hpp"
#include "io/provenance.hpp"
#include "run/jobs/finished_jobs.hpp"
#include "run/provenance.hpp"
#include "studies/program/plot.hpp"
#include "studies/program/repeating/reproduction.hpp"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <deque>
#include <filesystem>
#include <iostream>
#include <optional>
#include <set>
#include <thread>

namespace hilda::studies {

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

constexpr const char* record_name = "reproduce.json";
constexpr int most_processes = 4;

/// Starts this program with these words and this number of OpenMP threads, and its output in two new files.
/// Returns the process.
pid_t start(std::vector<std::string> words, int threads, const std::string& output,
            const std::string& messages)
{
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    const std::string omp_threads = std::to_string(threads);
    const pid_t parent = getpid(), child = fork();
    if (child == 0) {
        prctl(PR_SET_PDEATHSIG, SIGTERM);  // it does not outlive this process
        if (getppid() != parent) _exit(io::exit_code::not_available);
        // Threads that wait actively would slow down the studies beside this one.
        setenv("OMP_NUM_THREADS", omp_threads.c_str(), 0);
        setenv("OMP_WAIT_POLICY", "passive", 0);
        constexpr int create = O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW;
        if (dup2(::open("/dev/null", O_RDONLY), STDIN_FILENO) < 0 ||
            dup2(::open(output.c_str(), create, 0666), STDOUT_FILENO) < 0 ||
            dup2(::open(messages.c_str(), create, 0666), STDERR_FILENO) < 0)
            _exit(io::exit_code::input_output);
        execv("/proc/self/exe", argv.data());
        _exit(io::exit_code::not_available);
    }
    if (child < 0) throw io::IoError("a process cannot be started");
    return child;
}

std::string utc_now()
{
    const std::time_t now = std::time(nullptr);
    std::tm parts{};
    gmtime_r(&now, &parts);
    char text[40];
    return {text, std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", &parts)};
}

class Reproduce {
public:
    explicit Reproduce(const ReproduceOptions& o) : o(o)
    {
        const int jobs = o.jobs > 0 ? o.jobs : static_cast<int>(cores);
        processes = std::min(jobs, most_processes);
        jobs_each = std::max(1, jobs / processes);
    }

    int execute()
    {
        select();
        open_directory();
        const io::Interrupt interrupt;
        draw_missing();
        write_page();
        run_studies();
        write_page();
        return finish();
    }

private:
    struct Running {
        Reproduced* study;
        pid_t process;
        Clock::time_point begin;
    };

    std::string path(const std::string& file) const { return o.output + '/' + file; }

    void select()
    {
        std::set<int> known;
        for (const Reproduction& e : reproductions()) known.insert(e.chapter);
        for (const int chapter : o.chapters)
            if (!known.contains(chapter))
                throw io::UsageError(fmt::format("reproduce: --chapter must be one of {}, got {}",
                                                 fmt::join(known, ", "), chapter));
        for (const Reproduction& e : reproductions())
            if (o.chapters.empty() || std::count(o.chapters.begin(), o.chapters.end(), e.chapter) > 0)
                all.push_back({.entry = &e, .command = fmt::format("{}", fmt::join(e.words(o.full), " "))});
    }

    void open_directory()
    {
        std::error_code error;
        const bool begun = fs::is_regular_file(path(record_name), error);
        if (o.resume && !begun)
            throw io::UsageError(o.output + ": has no interrupted reproduction; --resume needs its file " +
                                 record_name);
        const bool accepted = o.force || o.resume;
        const std::string remedies =
            begun ? "--force overwrites it, --resume continues it" : io::force_overwrites;
        io::check_output_directory(o.output, accepted, remedies);
        lock.emplace(o.output, accepted, remedies).create();
        if (o.resume) read_record();
        io::write_file(path(record_name), record.text());
    }

    /// Reads the record, and the results of the studies that have ended with the same command.
    void read_record()
    {
        const io::Json old =
            io::JsonSource(io::read_file(path(record_name), io::JsonSource::max_bytes), path(record_name))
                .root;
        const auto text_of = [](const io::Json& object, const std::string& key) -> std::string {
            const io::Json::Member* member = object.member(key);
            return member != nullptr && member->value.string() != nullptr ? *member->value.string() : "";
        };
        for (const char* key : {"mode", "version"})
            if (const std::string its = text_of(old, key), mine = text_of(record, key); its != mine)
                throw io::UsageError(o.output + ": --resume needs the same " + key + ": '" + its +
                                     "' was begun, this is '" + mine + "'; --force starts again");
        if (const io::Json::Member* ended = old.member("finished");
            ended != nullptr && ended->value.members() != nullptr)
            record["finished"].update(ended->value);
        for (Reproduced& r : all) {
            const io::Json::Member* one = record["finished"].member(r.entry->name);
            if (one == nullptr || text_of(one->value, "command") != r.command) continue;
            const io::Json::Member *code = one->value.member("exit_code"),
                                   *seconds = one->value.member("seconds");
            if (code == nullptr || code->value.number() == nullptr || seconds == nullptr ||
                seconds->value.number() == nullptr)
                continue;
            r.exit_code = *code->value.number() == io::exit_code::done ? io::exit_code::done
                                                                       : io::exit_code::expectation_failed;
            r.seconds = *seconds->value.number();
            read_results(r, o.output);
        }
    }

    /// Whether a study has results and no figure of them
    bool lacks_figure(const Reproduced& r) const { return o.plot && r.has_ended() && r.figures.empty(); }

    /// Draws the figures of the studies that ended without them in an earlier process.
    void draw_missing()
    {
        for (Reproduced& r : all) {
            if (!lacks_figure(r) || io::Interrupt::caught() != 0) continue;
            const std::string in = path(r.entry->name);
            draw_figures(script_for(in), in, {});
            read_results(r, o.output);
            if (!o.quiet && !r.figures.empty())
                std::cout << fmt::format("{}, {}: drawn\n", r.entry->name, r.entry->figures) << std::flush;
        }
    }

    /// Studies that measure time run alone, at the end. The long studies are those of the last chapters: one
    /// process of several begins with the last one, so that no long study is alone at the end.
    void run_studies()
    {
        std::deque<Reproduced*> queue;
        for (const bool timed : {false, true})
            for (Reproduced& r : all)
                if (!r.has_ended() && r.entry->timed == timed) queue.push_back(&r);
        const auto first_timed =
            std::find_if(queue.begin(), queue.end(), [](const Reproduced* r) { return r->entry->timed; });
        if (processes > 1 && first_timed != queue.begin())
            std::rotate(queue.begin(), first_timed - 1, first_timed);
        const size_t count = queue.size();
        std::vector<Running> running;
        io::ProgressLine line(o.quiet);
        bool stopped = false;
        while (!queue.empty() || !running.empty()) {
            if (const int signal = io::Interrupt::caught(); signal != 0 && !stopped) {
                stopped = true;
                queue.clear();
                for (const Running& r : running) kill(r.process, signal);
            }
            while (!queue.empty() &&
                   static_cast<int>(running.size()) < (queue.front()->entry->timed ? 1 : processes)) {
                running.push_back(start_study(*queue.front()));
                queue.pop_front();
            }
            std::erase_if(running, [&](const Running& r) {
                int status = 1 << 8;  // if the exit code is not known
                if (waitpid(r.process, &status, WNOHANG) == 0) return false;
                line.clear();
                end_of(r, status, count);
                return true;
            });
            if (line.is_due() && !running.empty()) {
                // The studies take different times: the remaining time is a rough one.
                line.completed(static_cast<double>(ended_now) / static_cast<double>(count), 0);
                line.show(progress(running, count));
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        }
    }

    std::string progress(const std::vector<Running>& running, size_t count) const
    {
        std::string names;
        for (const Running& r : running)
            names += fmt::format("{}{} {:.0f} s", names.empty() ? "" : ", ", r.study->entry->name,
                                 seconds_since(r.begin));
        return fmt::format("{} of {} studies, {:.0f} s; {}", ended_now, count, seconds_since(begin), names);
    }

    Running start_study(Reproduced& r) const
    {
        const std::string in = path(r.entry->name);
        const int jobs = r.entry->timed ? 1 : jobs_each;
        std::vector<std::string> command = r.entry->words(o.full);
        command.insert(command.end(), {"--jobs", std::to_string(jobs), "--output", in});
        if (!o.plot) command.emplace_back("--no-plot");
        if (o.resume && run::FinishedJobs::in(in))
            command.emplace_back("--resume");
        else if (!io::is_missing_or_empty(in))
            command.emplace_back("--force");
        return {&r, start(std::move(command), jobs, in + ".txt", in + ".log"), Clock::now()};
    }

    void end_of(const Running& ended, int status, size_t count)
    {
        Reproduced& r = *ended.study;
        r.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : io::exit_code::signal + WTERMSIG(status);
        r.seconds = seconds_since(ended.begin);
        read_results(r, o.output);
        ++ended_now;
        if (r.has_ended())
            record["finished"][r.entry->name] = {
                {"command", r.command}, {"exit_code", r.exit_code}, {"seconds", r.seconds}};
        io::write_file(path(record_name), record.text());
        write_page();
        if (o.quiet) return;
        std::cout << fmt::format("[{:2}/{}] {}, {}: {}, {:.1f} s{}\n", ended_now, count, r.entry->name,
                                 r.entry->figures, r.status, r.seconds,
                                 r.status == "error" ? "; " + r.message
                                 : lacks_figure(r)   ? "; no figure: " + r.message
                                                     : "")
                  << std::flush;
    }

    long count(const std::string& status) const
    {
        return std::count_if(all.begin(), all.end(), [&](const Reproduced& r) { return r.status == status; });
    }

    void write_page() const
    {
        std::string counts;
        for (const char* status : {"passed", "failed", "error", "done", "interrupted", "not run"})
            if (count(status) > 0)
                counts += fmt::format("{}{} {}", counts.empty() ? "" : ", ", count(status), status);
        const std::string text =
            page(all,
                 {{"version", run::version_line()},
                  {"machine", fmt::format("{}, {}", io::processor(), io::counted(cores, "core"))},
                  {"date", utc_now()},
                  {"grids",
                   o.full ? "--full: those of the dissertation" : "--quick: reduced, as each section states"},
                  {"result", counts},
                  {"time", fmt::format("{:.0f} s", seconds_since(begin))}},
                 !o.full);
        io::write_file(path("index.html"), text);
    }

    int finish() const
    {
        const auto without_figure =
            std::count_if(all.begin(), all.end(), [this](const Reproduced& r) { return lacks_figure(r); });
        if (!o.quiet)
            std::cout << fmt::format(
                "{} passed, {} failed, {} without criterion, {} with an error{}; {}\n", count("passed"),
                count("failed"), count("done"), count("error"),
                without_figure == 0 ? "" : fmt::format(", {} without a figure", without_figure),
                path("index.html"));
        if (without_figure > 0)
            io::warning(
                fmt::format("{} without a figure; the same command with --resume draws what is missing",
                            io::counted(without_figure, "study", "studies")));
        if (const int signal = io::Interrupt::caught(); signal != 0) {
            if (!o.quiet) std::cout << "interrupted; the same command with --resume continues\n";
            return io::exit_code::signal + signal;
        }
        for (const Reproduced& r : all)
            if (r.status == "error" || r.status == "interrupted") return r.exit_code;
        return count("failed") > 0 ? io::exit_code::expectation_failed : io::exit_code::done;
    }

    const ReproduceOptions& o;
    const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
    int processes = 1, jobs_each = 1;
    std::vector<Reproduced> all;
    /// reproduce.json: the mode, the version, and by name the studies that have ended, also of other chapters
    io::Json record = {{"mode", o.full ? "full" : "quick"},
                       {"version", run::version_line()},
                       {"finished", io::Json::object()}};
    std::optional<io::OutputLock> lock;
    size_t ended_now = 0;
    const Clock::time_point begin = Clock::now();
};

}  // namespace

int reproduce(const ReproduceOptions& options)
{
    if (options.quick && options.full)
        throw io::UsageError("reproduce: --quick and --full exclude each other");
    if (options.force && options.resume)
        throw io::UsageError("reproduce: --force and --resume exclude each other");
    return Reproduce(options).execute();
}

}  // namespace hilda::studies
