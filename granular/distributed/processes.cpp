// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/distributed/processes.hpp"

#include "io/error.hpp"
#include "io/registry.hpp"

#include <cstdlib>
#include <cstring>

namespace hilda::granular {

std::unique_ptr<Processes> start_processes(int& argc, char**& argv)
{
    // A process that exchanges messages with hilda is not one of a run on several processes, even if mpirun
    // has started hilda.
    for (int k = 1; k < argc; ++k)
        if (std::strcmp(argv[k], "--exchange") == 0) return nullptr;
    for (const ProcessesType& type : io::Registry<ProcessesType>::all())
        if (std::unique_ptr<Processes> processes = type.start(argc, argv)) return processes;
    const char* const size = std::getenv("OMPI_COMM_WORLD_SIZE");
    if (io::Registry<ProcessesType>::all().empty() && size != nullptr && std::atoi(size) > 1)
        throw io::NotAvailable(
            "mpirun: hilda-granular was built without MPI and Zoltan, so that it runs on one process only "
            "(Debian: apt-get install libopenmpi-dev libtrilinos-zoltan-dev)");
    return nullptr;
}

}  // namespace hilda::granular
