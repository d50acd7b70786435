// SPDX-License-Identifier: GPL-3.0-or-later
/// Loads hilda-hdf5.so (hdf5.cpp) where --format hdf5 asks for it.
///
/// The program is not linked with HDF5: on Debian 12 the library loads 33 others, among them libcurl and
/// Kerberos, and every call of the program would start 16 ms later.

#include "run/tables/run_table.hpp"

#include "io/error.hpp"
#include "io/module.hpp"

namespace hilda::run {

namespace {

using MakeTables = void (*)(const std::string& directory, const RunRecord& record,
                            std::shared_ptr<RunTables>& tables);

}  // namespace

std::shared_ptr<RunTables> hdf5_tables(const std::string& directory, const RunRecord& record)
{
    void* const symbol = io::module_symbol("--format hdf5",
                                           {.name = "hilda-hdf5.so",
                                            .library_folder = HILDA_LIBRARY_FOLDER,
                                            .caller = reinterpret_cast<const void*>(&hdf5_tables)},
                                           "hilda_hdf5_tables");
    if (symbol == nullptr)
        io::refuse_without_module("--format hdf5", "hilda-hdf5.so", "hilda_hdf5", "libhdf5-dev");
    std::shared_ptr<RunTables> tables;
    reinterpret_cast<MakeTables>(symbol)(directory, record, tables);
    return tables;
}

}  // namespace hilda::run
