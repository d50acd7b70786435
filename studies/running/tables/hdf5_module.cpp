// SPDX-License-Identifier: GPL-3.0-or-later
/// Loads hilda-hdf5.so (hdf5.cpp, hdf5_file.cpp and hdf5_storage.cpp) where --format hdf5 asks for it.
///
/// The program is not linked with HDF5: on Debian 12 the library loads 33 others, among them libcurl and
/// Kerberos, and every call of the program would start 16 ms later.

#include "studies/running/tables/run_table.hpp"

#include <dlfcn.h>

#include <filesystem>
#include <vector>

namespace hilda::studies {

namespace {

namespace fs = std::filesystem;

using MakeTables = void (*)(const std::string& directory, const RunRecord& record,
                            std::shared_ptr<RunTables>& tables);

/// The module beside the program (in the build folder, also of the tests) or in lib/hilda of the
/// installation; empty if there is none. A program that is linked with libhilda_studies.so may be anywhere.
fs::path module()
{
    std::error_code error;
    const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
    std::vector<fs::path> places = {folder, folder.parent_path(),
                                    folder.parent_path() / HILDA_LIBRARY_FOLDER};
    Dl_info here{};
    if (dladdr(reinterpret_cast<const void*>(&hdf5_tables), &here) != 0 && here.dli_fname[0] == '/')
        places.push_back(fs::path(here.dli_fname).parent_path() / "hilda");
    for (const fs::path& place : places)
        if (fs::is_regular_file(place / "hilda-hdf5.so", error)) return place / "hilda-hdf5.so";
    return {};
}

}  // namespace

std::shared_ptr<RunTables> hdf5_tables(const std::string& directory, const RunRecord& record)
{
    const fs::path file = module();
    if (file.empty())
        throw io::NotAvailable(
            "--format hdf5: this program was built without HDF5; install it (Debian: apt-get install "
            "libhdf5-dev), then configure and build again, or use --format csv");
    void* loaded = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    void* symbol = loaded == nullptr ? nullptr : dlsym(loaded, "hilda_hdf5_tables");
    if (symbol == nullptr) throw io::NotAvailable(std::string("--format hdf5: ") + dlerror());
    std::shared_ptr<RunTables> tables;
    reinterpret_cast<MakeTables>(symbol)(directory, record, tables);
    return tables;
}

}  // namespace hilda::studies
