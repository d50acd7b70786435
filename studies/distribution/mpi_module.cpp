// SPDX-License-Identifier: GPL-3.0-or-later
/// Loads hilda-mpi.so (mpi.cpp) where mpirun has started several ranks. Without mpirun the program does not
/// load MPI.

#include "studies/distribution/communicator.hpp"

#include "io/error.hpp"
#include "io/option_values.hpp"

#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>
#include <vector>

namespace hilda::studies {

namespace {

namespace fs = std::filesystem;

int variable(const char* name, int otherwise)
{
    const char* text = std::getenv(name);
    return text == nullptr ? otherwise : io::number_in<int>(text).value_or(otherwise);
}

/// The module beside the program (in the build folder, also of the tests) or in lib/hilda of the
/// installation; empty if there is none.
fs::path module()
{
    std::error_code error;
    const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
    std::vector<fs::path> places = {folder, folder.parent_path(),
                                    folder.parent_path() / HILDA_LIBRARY_FOLDER};
    Dl_info here{};
    if (dladdr(reinterpret_cast<const void*>(&make_communicator), &here) != 0 && here.dli_fname[0] == '/')
        places.push_back(fs::path(here.dli_fname).parent_path() / "hilda");
    for (const fs::path& place : places)
        if (fs::is_regular_file(place / "hilda-mpi.so", error)) return place / "hilda-mpi.so";
    return {};
}

}  // namespace

int ranks_of_environment() { return variable("OMPI_COMM_WORLD_SIZE", 1); }
int rank_of_environment() { return variable("OMPI_COMM_WORLD_RANK", 0); }

std::unique_ptr<Communicator> make_communicator()
{
    const fs::path file = module();
    if (file.empty())
        throw io::NotAvailable(
            "mpirun: this program was built without MPI; install it (Debian: apt-get install "
            "libopenmpi-dev), then configure and build again, or use --shard");
    // Global: the components of Open MPI use its symbols.
    void* loaded = dlopen(file.c_str(), RTLD_NOW | RTLD_GLOBAL);
    void* symbol = loaded == nullptr ? nullptr : dlsym(loaded, "hilda_mpi");
    if (symbol == nullptr) throw io::NotAvailable(std::string("mpirun: ") + dlerror());
    std::unique_ptr<Communicator> made;
    reinterpret_cast<void (*)(std::unique_ptr<Communicator>&)>(symbol)(made);
    return made;
}

}  // namespace hilda::studies
