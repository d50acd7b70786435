// SPDX-License-Identifier: GPL-3.0-or-later
/// Loads hilda-mpi.so (mpi.cpp) for hilda cosim --transport mpi. Otherwise the program does not load MPI.

#include "run/cosim/communicator.hpp"

#include "io/error.hpp"
#include "io/module.hpp"
#include "io/option_values.hpp"

#include <cstdlib>

namespace hilda::run {

namespace {

int variable(const char* name, int otherwise)
{
    const char* text = std::getenv(name);
    return text == nullptr ? otherwise : io::number_in<int>(text).value_or(otherwise);
}

}  // namespace

int ranks_of_environment() { return variable("OMPI_COMM_WORLD_SIZE", 1); }
int rank_of_environment() { return variable("OMPI_COMM_WORLD_RANK", 0); }

std::unique_ptr<Communicator> make_communicator()
{
    // Global: the components of Open MPI use its symbols.
    void* const symbol = io::module_symbol("mpirun",
                                           {.name = "hilda-mpi.so",
                                            .library_folder = HILDA_LIBRARY_FOLDER,
                                            .caller = reinterpret_cast<const void*>(&make_communicator),
                                            .global = true},
                                           "hilda_mpi");
    if (symbol == nullptr) io::refuse_without_module("mpirun", "hilda-mpi.so", "hilda_mpi", "libopenmpi-dev");
    std::unique_ptr<Communicator> made;
    reinterpret_cast<void (*)(std::unique_ptr<Communicator>&)>(symbol)(made);
    return made;
}

}  // namespace hilda::run
