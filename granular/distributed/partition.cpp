// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/distributed/partition.hpp"

#include <zoltan.h>

#include <stdexcept>
#include <string>

namespace hilda::granular {

namespace {

void check_partition(int code, const char* function)
{
    if (code == ZOLTAN_FATAL || code == ZOLTAN_MEMERR)
        throw std::runtime_error(std::string(function) + " of Zoltan has failed");
}

struct NumberOfBlocks {
    std::uint64_t count = 0;
    NumberOfBlocks& operator+=(const NumberOfBlocks& o)
    {
        count += o.count;
        return *this;
    }
};

}  // namespace

/// The blocks of this process, as Zoltan asks for them
struct Partition::Objects {
    const Partition& of;
    const std::vector<BlockWork>& work;

    static const Objects& from(void* data) { return *static_cast<const Objects*>(data); }
    static int count(void* data, int* error)
    {
        *error = ZOLTAN_OK;
        return static_cast<int>(from(data).work.size());
    }
    static void list(void* data, int, int, ZOLTAN_ID_PTR global, ZOLTAN_ID_PTR, int, float* weights,
                     int* error)
    {
        const std::vector<BlockWork>& all = from(data).work;
        for (std::size_t k = 0; k < all.size(); ++k) global[k] = all[k].block, weights[k] = all[k].weight;
        *error = ZOLTAN_OK;
    }
    static int dimensions(void*, int* error)
    {
        *error = ZOLTAN_OK;
        return 3;
    }
    static void places(void* data, int, int, int count, ZOLTAN_ID_PTR global, ZOLTAN_ID_PTR, int, double* x,
                       int* error)
    {
        for (int k = 0; k < count; ++k) from(data).of.place(global[k], x + 3 * k);
        *error = ZOLTAN_OK;
    }
};

Partition::Partition(const Communicator& all) : all(all), zoltan(Zoltan_Create(all.handle()))
{
    if (zoltan == nullptr) throw std::runtime_error("Zoltan_Create of Zoltan has failed");
    for (const auto& [name, value] : {std::pair{"DEBUG_LEVEL", "0"},
                                      {"LB_METHOD", "RCB"},
                                      {"NUM_GID_ENTRIES", "1"},
                                      {"NUM_LID_ENTRIES", "0"},
                                      {"OBJ_WEIGHT_DIM", "1"},
                                      {"KEEP_CUTS", "1"},
                                      {"RCB_OUTPUT_LEVEL", "0"},
                                      {"CHECK_GEOM", "0"},
                                      {"RETURN_LISTS", "NONE"},
                                      {"REMAP", "0"},
                                      {"IMBALANCE_TOL", "1.01"}})
        check_partition(Zoltan_Set_Param(zoltan, name, value), "Zoltan_Set_Param");
}

Partition::~Partition() { Zoltan_Destroy(&zoltan); }

/// A place of a block that differs from those of the others along each axis, so that a cut never has to
/// divide blocks at the same coordinate.
void Partition::place(std::uint32_t block, double* x) const
{
    const double nx = blocks.blocks[0], ny = blocks.blocks[1], nz = blocks.blocks[2];
    const std::uint32_t row = block / blocks.blocks[0], layer = row / blocks.blocks[1];
    const double i = block % blocks.blocks[0], j = row % blocks.blocks[1], k = layer;
    x[0] = i + (j + k / nz) / ny, x[1] = j + (k + i / nx) / nz, x[2] = k + (i + j / ny) / nx;
}

void Partition::make(const CellGrid& cells, std::int32_t shift, const std::vector<BlockWork>& work)
{
    blocks = BlockGrid(cells, shift);
    std::copy_n(cells.cells, 3, of_cells);
    owners.assign(static_cast<std::size_t>(blocks.count()), -1);
    is_cut = all.reduced_for_all(NumberOfBlocks{work.size()}).count > 0;
    if (!is_cut) return;
    Objects objects{*this, work};
    Zoltan_Set_Num_Obj_Fn(zoltan, Objects::count, &objects);
    Zoltan_Set_Obj_List_Fn(zoltan, Objects::list, &objects);
    Zoltan_Set_Num_Geom_Fn(zoltan, Objects::dimensions, &objects);
    Zoltan_Set_Geom_Multi_Fn(zoltan, Objects::places, &objects);
    int changes = 0, global = 0, local = 0, imports = 0, exports = 0;
    ZOLTAN_ID_PTR import_global = nullptr, import_local = nullptr, export_global = nullptr,
                  export_local = nullptr;
    int *import_process = nullptr, *import_part = nullptr, *export_process = nullptr, *export_part = nullptr;
    check_partition(Zoltan_LB_Partition(zoltan, &changes, &global, &local, &imports, &import_global,
                                        &import_local, &import_process, &import_part, &exports,
                                        &export_global, &export_local, &export_process, &export_part),
                    "Zoltan_LB_Partition");
    Zoltan_LB_Free_Part(&import_global, &import_local, &import_process, &import_part);
    Zoltan_LB_Free_Part(&export_global, &export_local, &export_process, &export_part);
}

int Partition::found_owner(std::uint32_t block) const
{
    if (!is_cut) return static_cast<int>(block * static_cast<std::uint64_t>(all.size()) / owners.size());
    double x[3];
    place(block, x);
    int process = 0, part = 0;
    check_partition(Zoltan_LB_Point_PP_Assign(zoltan, x, &process, &part), "Zoltan_LB_Point_PP_Assign");
    return process;
}

}  // namespace hilda::granular
