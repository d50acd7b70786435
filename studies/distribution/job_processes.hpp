// SPDX-License-Identifier: GPL-3.0-or-later
/// Jobs in processes of their own: a job that ends its process costs its own result only.

#pragma once

#include <sys/types.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace hilda::studies {

/// How a job has ended
struct JobEnd {
    enum Kind : char {
        computed,  ///< text: the result
        threw,     ///< text: the exception, see rethrow()
        killed     ///< text: how the process ended
    };

    long job = 0;
    Kind kind = computed;
    std::string text;

    /// Throws an exception of the type and with the text of the one that the job threw.
    [[noreturn]] void rethrow() const;
};

class JobProcesses {
public:
    /// compute(job) returns the result as bytes. It is called in copies (fork) of this process, at most
    /// `count` at a time, each of which computes several jobs.
    JobProcesses(int count, std::function<std::string(long)> compute);
    /// Ends the processes.
    ~JobProcesses();
    JobProcesses(const JobProcesses&) = delete;
    JobProcesses& operator=(const JobProcesses&) = delete;

    /// Whether a job can be started
    bool has_free() const { return free_one() < children.size(); }
    void start(long job);
    /// Waits at most `microseconds` for the end of a job.
    std::optional<JobEnd> wait(long microseconds);

private:
    struct Child {
        pid_t process = 0;  ///< 0: not started
        int to = -1, from = -1;
        std::optional<long> job = {};
    };

    size_t free_one() const;
    void fork_child(Child& child);
    [[noreturn]] void serve(int from, int to) const;
    JobEnd end_of(Child& child);
    static std::string end_process(Child& child);

    std::function<std::string(long)> compute;
    std::vector<Child> children;
};

}  // namespace hilda::studies
