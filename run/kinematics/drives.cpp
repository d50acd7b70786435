// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/kinematics/drives.hpp"

#include "dae/driver.hpp"
#include "dae/model.hpp"

#include <utility>

namespace hilda::run {

namespace {

/// Whether a function of time is the sine of an angle, not its cosine; see dae::Driver::complement.
bool is_sine(const dae::Driver& f)
{
    const std::string& text = f.text();
    return text.compare(text.find_first_not_of(" \t(+"), 3, "sin") == 0;
}

}  // namespace

std::vector<DriveColumns::Drive> DriveColumns::drives_of(const dae::Model& model)
{
    std::vector<Drive> drives;
    const std::vector<int>& active = model.active_rows();
    for (size_t k = 0; k < active.size(); ++k) {
        const auto row = static_cast<size_t>(active[k]);
        if (model.all_rows()[row].block->prescribed() != nullptr)
            drives.push_back({row, static_cast<int>(k)});
    }
    return drives;
}

std::vector<dae::Quantity> DriveColumns::columns_of(const dae::Model& model, const std::vector<Drive>& drives)
{
    std::vector<dae::Quantity> columns;
    for (const Drive& drive : drives) {
        const std::string& name = model.constraint_name(model.all_rows()[drive.row].constraint);
        columns.push_back({name + ".value", "", "prescribed function f"});
        columns.push_back({name + ".rate", "", "df/dt"});
        columns.push_back({name + ".acceleration", "", "d2f/dt2"});
        columns.push_back({name + ".load", "", "load of the driver, conjugate to f or to its angle"});
        columns.push_back({name + ".power", "W", "power of the driver on the bodies"});
    }
    return columns;
}

DriveColumns::DriveColumns(const dae::Model& model) : DriveColumns(model, drives_of(model)) {}

DriveColumns::DriveColumns(const dae::Model& model, std::vector<Drive> of)
    : ColumnGroup(columns_of(model, of)), model(model), drives(std::move(of))
{}

void DriveColumns::values(const lie::State& x, double* out)
{
    for (const Drive& drive : drives) {
        const dae::Model::Row& row = model.all_rows()[drive.row];
        const dae::Block& active = row.active_block(x);
        const io::Jet f = row.block->prescribed()->jet(x.t);
        const double load = -x.lambda[drive.multiplier];
        double per_angle = 1;  // df/dg, or dc/dg while the complement c is active
        if (row.complement) {
            const double sign = is_sine(*row.block->prescribed()) ? 1 : -1;
            per_angle =
                &active == row.block.get() ? sign * row.complement->prescribed()->f(x.t) : -sign * f.f;
        }
        *out++ = f.f, *out++ = f.fdot, *out++ = f.fddot;
        *out++ = load * per_angle, *out++ = load * active.prescribed()->fdot(x.t);
    }
}

}  // namespace hilda::run
