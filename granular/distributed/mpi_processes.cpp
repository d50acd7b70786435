// SPDX-License-Identifier: GPL-3.0-or-later
// The processes that mpirun starts.
#include "granular/distributed/commands.hpp"
#include "granular/distributed/processes.hpp"
#include "io/archive.hpp"
#include "io/error.hpp"
#include "io/message.hpp"
#include "io/registry.hpp"

#include <signal.h>
#include <unistd.h>
#include <zoltan.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace hilda::granular {

namespace {

/// Ends this process with the exit code of a numerical failure when another process on this machine has
/// disappeared: a message from it would be awaited without end.
class ProcessWatch {
public:
    explicit ProcessWatch(const Communicator& all) : others(processes_here(all))
    {
        watch = std::thread([this] {
            while (!ends) {
                std::this_thread::sleep_for(std::chrono::milliseconds(50));
                for (const pid_t other : others)
                    if (!ends && kill(other, 0) != 0) leave();
            }
        });
    }
    ~ProcessWatch()
    {
        ends = true;
        watch.join();
    }
    ProcessWatch(const ProcessWatch&) = delete;
    ProcessWatch& operator=(const ProcessWatch&) = delete;

private:
    static std::vector<pid_t> processes_here(const Communicator& all)
    {
        MPI_Comm here = MPI_COMM_NULL;
        MPI_Comm_split_type(all.handle(), MPI_COMM_TYPE_SHARED, all.rank(), MPI_INFO_NULL, &here);
        int count = 0;
        MPI_Comm_size(here, &count);
        std::vector<int> ids(static_cast<std::size_t>(count));
        const int own = getpid();
        MPI_Allgather(&own, 1, MPI_INT, ids.data(), 1, MPI_INT, here);
        MPI_Comm_free(&here);
        std::vector<pid_t> others;
        for (const int id : ids)
            if (id != own) others.push_back(id);
        return others;
    }
    [[noreturn]] static void leave()
    {
        constexpr char text[] =
            "hilda: error: another process of the run has disappeared; --resume continues from the last "
            "checkpoint\n";
        [[maybe_unused]] const auto written = write(STDERR_FILENO, text, sizeof text - 1);
        _exit(io::exit_code::numerical_failure);
    }

    const std::vector<pid_t> others;
    std::atomic<bool> ends = false;
    std::thread watch;
};

class MpiProcesses final : public Processes, private EngineSource {
public:
    MpiProcesses() : all(MPI_COMM_WORLD), watch(std::make_unique<ProcessWatch>(all)) {}
    ~MpiProcesses() override
    {
        watch.reset();
        MPI_Finalize();
    }
    MpiProcesses(const MpiProcesses&) = delete;
    MpiProcesses& operator=(const MpiProcesses&) = delete;

    int count() const override { return all.size(); }
    bool is_first() const override { return all.is_first(); }
    EngineSource& engines() override { return *this; }
    int serve() override
    {
        // The first process ends the run after an interruption.
        std::signal(SIGINT, SIG_IGN), std::signal(SIGHUP, SIG_IGN), std::signal(SIGTERM, SIG_IGN);
        return serve_engines(all);
    }
    void end(int code) override
    {
        if (all.in_call) abort(code);
        end_processes(all, code);
    }
    std::string report() const override
    {
        const Imbalance& i = all.imbalance;
        return io::formatted(
            "%d processes: work of the busiest over the mean, minus 1: %.2g measured, %.2g predicted for the "
            "last of %ld divisions of the domain",
            all.size(), i.measured(), i.predicted, i.divisions);
    }
    void abort(int code) override
    {
        watch.reset();
        MPI_Abort(MPI_COMM_WORLD, code);
        std::_Exit(code);
    }

private:
    std::unique_ptr<Engine> make() override { return std::make_unique<FirstEngine>(all, ++engines_made); }

    const Communicator all;
    std::unique_ptr<ProcessWatch> watch;
    int engines_made = 0;
};

/// Throws io::UsageError in all processes if their arguments or folders differ: they are then meant as runs
/// of their own.
void require_same_arguments(const Communicator& all, int argc, char** argv)
{
    std::string text = std::filesystem::current_path().string();
    for (int k = 1; k < argc; ++k) text += '\n' + std::string(argv[k]);
    struct Range {
        std::uint64_t least, largest;
        Range& operator+=(const Range& o)
        {
            least = std::min(least, o.least), largest = std::max(largest, o.largest);
            return *this;
        }
    };
    const std::uint64_t own = io::checksum(text.data(), text.size());
    const Range of_all = all.reduced_for_all(Range{own, own});
    if (of_all.largest == of_all.least) return;
    MPI_Finalize();
    if (!all.is_first()) std::_Exit(io::exit_code::wrong_command_line);  // one message is enough
    throw io::UsageError(
        "mpirun: the processes have different arguments or folders; they compute one case together, and runs "
        "of their own are started without mpirun");
}

std::unique_ptr<Processes> start(int& argc, char**& argv)
{
    // srun with PMIx sets no variable with the number of processes.
    bool is_started = std::getenv("PMIX_RANK") != nullptr;
    for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MPI_LOCALNRANKS"})
        if (const char* const size = std::getenv(name); size != nullptr)
            is_started = is_started || std::atoi(size) > 1;
    if (!is_started) return nullptr;
    MPI_Init(&argc, &argv);
    int size = 1;
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    if (size <= 1) {
        MPI_Finalize();
        return nullptr;
    }
    require_same_arguments(Communicator(MPI_COMM_WORLD), argc, argv);
    float version = 0;
    if (Zoltan_Initialize(argc, argv, &version) != ZOLTAN_OK)
        throw std::runtime_error("Zoltan_Initialize of Zoltan has failed");
    return std::make_unique<MpiProcesses>();
}

const bool registered_mpi_processes = io::Registry<ProcessesType>::add({.name = "MPI", .start = start});

}  // namespace

}  // namespace hilda::granular
