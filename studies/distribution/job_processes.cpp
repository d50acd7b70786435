// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/distribution/job_processes.hpp"

#include "io/archive.hpp"
#include "io/descriptor.hpp"
#include "io/error.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <iostream>

namespace hilda::studies {

namespace {

bool write_all(int descriptor, const void* bytes, size_t count)
{
    return io::write_all(descriptor, bytes, count) == count;
}

bool read_all(int descriptor, void* bytes, size_t count)
{
    return io::read_all(descriptor, bytes, count) == count;
}

/// Begins each result.
struct Header {
    JobEnd::Kind kind;
    size_t length;
};

enum Thrown : int { other, invalid_input, numerical_failure, failure };

std::string exception_text(Thrown type, int code, std::string status, std::string what)
{
    io::Archive a;
    a.value(type), a.value(code), a.list(status), a.list(what);
    return a.bytes();
}

}  // namespace

void JobEnd::rethrow() const
{
    io::Archive a(text, "the exception of a run");
    Thrown type = other;
    int code = 0;
    std::string status, what;
    a.value(type), a.value(code), a.list(status), a.list(what);
    if (type == invalid_input) throw io::InvalidInput(what);
    if (type == numerical_failure) throw io::NumericalFailure(status, what);
    if (type == failure) throw io::Failure(code, what);
    throw std::runtime_error(what);
}

JobProcesses::JobProcesses(int count, std::function<std::string(long)> compute)
    : compute(std::move(compute)), children(static_cast<size_t>(std::max(1, count)))
{
    std::signal(SIGPIPE, SIG_IGN);  // a process may end before it reads its job
}

JobProcesses::~JobProcesses()
{
    for (Child& child : children) {
        if (child.process == 0) continue;
        kill(child.process, SIGKILL);
        end_process(child);
    }
}

size_t JobProcesses::free_one() const
{
    const auto at =
        std::find_if(children.begin(), children.end(), [](const Child& child) { return !child.job; });
    return static_cast<size_t>(at - children.begin());
}

void JobProcesses::start(long job)
{
    Child& child = children[free_one()];
    if (child.process == 0) fork_child(child);
    child.job = job;
    // On failure the end of the process is reported by wait().
    static_cast<void>(write_all(child.to, &job, sizeof job));
}

void JobProcesses::fork_child(Child& child)
{
    std::array<int, 2> jobs{-1, -1}, results{-1, -1};
    const auto fail = [&](const std::string& what) {
        const std::string reason = std::strerror(errno);
        for (const int descriptor : {jobs[0], jobs[1], results[0], results[1]})
            if (descriptor >= 0) close(descriptor);
        throw io::IoError(what + reason);
    };
    if (pipe2(jobs.data(), O_CLOEXEC) != 0 || pipe2(results.data(), O_CLOEXEC) != 0)
        fail("a process for a run: no pipe: ");
    std::cout.flush();
    const pid_t parent = getpid(), process = fork();
    if (process < 0) fail("a process for a run cannot be started: ");
    if (process == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (getppid() != parent) _exit(1);
        for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_DFL);
        // With the ends of other processes it would keep their pipes open after their end.
        for (const Child& other : children)
            if (other.to >= 0) close(other.to), close(other.from);
        close(jobs[1]), close(results[0]);
        serve(jobs[0], results[1]);
    }
    close(jobs[0]), close(results[1]);
    child.process = process;
    child.to = jobs[1], child.from = results[0];
}

/// The loop of a process: computes jobs until the pipe is closed.
void JobProcesses::serve(int from, int to) const
{
    long job = 0;
    while (read_all(from, &job, sizeof job)) {
        JobEnd end;
        try {
            end.text = compute(job);
        } catch (const io::InvalidInput& e) {
            end.kind = JobEnd::threw, end.text = exception_text(invalid_input, 0, "", e.what());
        } catch (const io::NumericalFailure& e) {
            end.kind = JobEnd::threw, end.text = exception_text(numerical_failure, 0, e.status, e.what());
        } catch (const io::Failure& e) {
            end.kind = JobEnd::threw, end.text = exception_text(failure, e.code, "", e.what());
        } catch (const std::exception& e) {
            end.kind = JobEnd::threw, end.text = exception_text(other, 0, "", e.what());
        } catch (...) {
            end.kind = JobEnd::threw, end.text = exception_text(other, 0, "", "an unknown exception");
        }
        const Header header{end.kind, end.text.size()};
        if (!write_all(to, &header, sizeof header) || !write_all(to, end.text.data(), end.text.size())) break;
    }
    _exit(0);  // without the destructors of the process that was copied
}

std::optional<JobEnd> JobProcesses::wait(long microseconds)
{
    std::vector<pollfd> running;
    for (const Child& child : children)
        if (child.job) running.push_back({child.from, POLLIN, 0});
    const timespec limit{microseconds / 1000000, microseconds % 1000000 * 1000};
    if (ppoll(running.data(), running.size(), &limit, nullptr) <= 0) return std::nullopt;
    for (const pollfd& ready : running) {
        if (ready.revents == 0) continue;
        for (Child& child : children)
            if (child.from == ready.fd && child.job) return end_of(child);
    }
    return std::nullopt;
}

JobEnd JobProcesses::end_of(Child& child)
{
    JobEnd end{.job = *child.job, .text = {}};
    child.job.reset();
    Header header{};
    if (read_all(child.from, &header, sizeof header)) {
        end.kind = header.kind;
        end.text.resize(header.length);
        if (read_all(child.from, end.text.data(), header.length)) return end;
    }
    end.kind = JobEnd::killed;
    end.text = end_process(child);
    return end;
}

/// Waits for the end of the process and returns a text about it.
std::string JobProcesses::end_process(Child& child)
{
    close(child.to), close(child.from);
    int status = 0;
    while (waitpid(child.process, &status, 0) < 0 && errno == EINTR) {
    }
    child = {};
    if (WIFSIGNALED(status))
        return fmt::format("the process of the run was ended by signal {} ({})", WTERMSIG(status),
                           strsignal(WTERMSIG(status)));
    return fmt::format("the process of the run ended with exit code {}", WEXITSTATUS(status));
}

}  // namespace hilda::studies
