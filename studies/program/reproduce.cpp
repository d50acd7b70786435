// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/reproduce.hpp"

#include "io/error.hpp"
#include "io/files.hpp"
#include "io/message.hpp"
#include "io/program.hpp"
#include "io/progress.hpp"
#include "io/provenance.hpp"
#include "studies/program/reproduction_page.hpp"
#include "studies/running/finished_jobs.hpp"
#include "studies/running/provenance.hpp"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
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

/// A new file for the output of a process; closed at the end of its life
class NewFile {
public:
    explicit NewFile(const std::string& file)
        : descriptor(::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666))
    {
        if (descriptor < 0) throw io::IoError(file + ": cannot be written: " + std::strerror(errno));
    }
    ~NewFile() { close(descriptor); }
    NewFile(const NewFile&) = delete;
    NewFile& operator=(const NewFile&) = delete;

    const int descriptor;
};

/// Starts this program with these words and this number of OpenMP threads, and its output in two files.
/// Returns the process.
pid_t start(std::vector<std::string> words, int threads, const std::string& output,
            const std::string& messages)
{
    const NewFile out(output), err(messages);
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
        dup2(::open("/dev/null", O_RDONLY), STDIN_FILENO);
        dup2(out.descriptor, STDOUT_FILENO);
        dup2(err.descriptor, STDERR_FILENO);
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
    explicit Reproduce(const ReproduceOptions& o) : o(o), mode(o.full ? "full" : "quick")
    {
        const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
        const int jobs = o.jobs > 0 ? o.jobs : static_cast<int>(cores);
        processes = std::min(jobs, most_processes);
        jobs_each = std::max(1, jobs / processes);
        machine = fmt::format("{}, {}", io::processor(), io::counted(cores, "core"));
    }

    int execute()
    {
        select();
        open_directory();
        const io::Interrupt interrupt;
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
        for (const Reproduction& e : reproductions()) {
            if (!o.chapters.empty() &&
                std::find(o.chapters.begin(), o.chapters.end(), e.chapter) == o.chapters.end())
                continue;
            Reproduced& r = all.emplace_back();
            r.entry = &e;
            for (const std::string& word : words(e)) r.command += (r.command.empty() ? "" : " ") + word;
        }
    }

    /// The command without the options of this run
    std::vector<std::string> words(const Reproduction& e) const
    {
        std::vector<std::string> all_words = {"hilda", "study", e.study};
        for (const auto* more : {&e.arguments, mode == "quick" ? &e.quick : &e.full})
            all_words.insert(all_words.end(), more->begin(), more->end());
        return all_words;
    }

    void open_directory()
    {
        std::error_code error;
        const bool begun = fs::is_regular_file(path(record_name), error);
        if (o.resume && !begun)
            throw io::UsageError(o.output + ": has no interrupted reproduction; --resume needs its file " +
                                 record_name);
        io::check_output_directory(
            o.output, o.force || o.resume,
            begun ? "--force overwrites it, --resume continues it" : io::force_overwrites);
        lock.emplace(o.output).create();
        if (o.resume) others = read_record(path(record_name), o.output, mode, all);
        write_record();
    }

    void write_record() const { io::write_file(path(record_name), record_of(all, others, mode).text()); }

    void run_studies()
    {
        // Those that measure time run at the end, alone.
        std::deque<Reproduced*> queue, timed;
        for (Reproduced& r : all)
            if (!has_ended(r)) (r.entry->timed ? timed : queue).push_back(&r);
        const size_t count = queue.size() + timed.size();
        std::vector<Running> running;
        io::ProgressLine line(o.quiet);
        bool stopped = false;
        while (!queue.empty() || !timed.empty() || !running.empty()) {
            if (const int signal = io::Interrupt::caught(); signal != 0 && !stopped) {
                stopped = true;
                queue.clear(), timed.clear();
                for (const Running& r : running) kill(r.process, signal);
            }
            while (!queue.empty() && static_cast<int>(running.size()) < processes)
                start_next(queue, running, jobs_each);
            if (queue.empty() && running.empty() && !timed.empty()) start_next(timed, running, 1);
            for (size_t k = 0; k < running.size();) {
                int status = 0;
                const pid_t found = waitpid(running[k].process, &status, WNOHANG);
                if (found == -1 && errno == ECHILD) status = 1 << 8;  // its exit code is not known
                if (found != running[k].process && !(found == -1 && errno == ECHILD)) {
                    ++k;
                    continue;
                }
                line.clear();
                const Running ended = running[k];
                running.erase(running.begin() + static_cast<std::ptrdiff_t>(k));
                end_of(ended, status, count);
            }
            if (line.is_due() && !running.empty()) line.show(progress(running, count));
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

    /// The long studies are those of the last chapters. One process of several begins with them, so that no
    /// long study is alone at the end.
    void start_next(std::deque<Reproduced*>& queue, std::vector<Running>& running, int jobs) const
    {
        const bool from_end = processes > 1 && running.empty();
        Reproduced& r = from_end ? *queue.back() : *queue.front();
        from_end ? queue.pop_back() : queue.pop_front();
        const std::string in = path(r.entry->name);
        std::vector<std::string> command = words(*r.entry);
        command.insert(command.end(), {"--jobs", std::to_string(jobs), "--output", in});
        if (!o.plot) command.emplace_back("--no-plot");
        if (o.resume && FinishedJobs::in(in))
            command.emplace_back("--resume");
        else if (!io::is_missing_or_empty(in))
            command.emplace_back("--force");
        running.push_back({&r, start(std::move(command), jobs, in + ".txt", in + ".log"), Clock::now()});
    }

    void end_of(const Running& ended, int status, size_t count)
    {
        Reproduced& r = *ended.study;
        r.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : io::exit_code::signal + WTERMSIG(status);
        r.seconds = seconds_since(ended.begin);
        read_results(r, o.output);
        ++ended_now;
        write_record();
        write_page();
        if (o.quiet) return;
        std::cout << fmt::format("[{:2}/{}] {}, {}: {}, {:.1f} s{}\n", ended_now, count, r.entry->name,
                                 names_of_figures(*r.entry), r.status, r.seconds,
                                 r.status == "error" ? "; " + r.message : "")
                  << std::flush;
    }

    void write_page() const
    {
        io::write_file(path("index.html"), page(all, {.mode = mode,
                                                      .version = version_line(),
                                                      .machine = machine,
                                                      .date = utc_now(),
                                                      .seconds = seconds_since(begin)}));
    }

    int finish() const
    {
        const auto count = [&](const std::string& status) {
            return std::count_if(all.begin(), all.end(),
                                 [&](const Reproduced& r) { return r.status == status; });
        };
        if (!o.quiet)
            std::cout << fmt::format("{} passed, {} failed, {} without criterion, {} with an error; {}\n",
                                     count("passed"), count("failed"), count("done"), count("error"),
                                     path("index.html"));
        if (const int signal = io::Interrupt::caught(); signal != 0) {
            if (!o.quiet) std::cout << "interrupted; the same command with --resume continues\n";
            return io::exit_code::signal + signal;
        }
        for (const Reproduced& r : all)
            if (r.status == "error" || r.status == "interrupted") return r.exit_code;
        return count("failed") > 0 ? io::exit_code::expectation_failed : io::exit_code::done;
    }

    const ReproduceOptions& o;
    const std::string mode;
    int processes = 1, jobs_each = 1;
    std::string machine;
    std::vector<Reproduced> all;
    io::Json::List others;  ///< finished studies of other chapters
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
