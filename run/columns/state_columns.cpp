// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/columns/state_columns.hpp"

#include "dae/model.hpp"

#include <fmt/format.h>

#include <cmath>

namespace hilda::run {

namespace {

std::vector<dae::Quantity> columns_of_bodies(const dae::Model& model)
{
    std::vector<dae::Quantity> all;
    const auto add = [&](const std::string& body, std::initializer_list<const char*> names, const char* unit,
                         const char* meaning) {
        for (const char* name : names) all.push_back({body + '.' + name, unit, meaning});
    };
    for (const dae::Body& b : model.all_bodies()) {
        add(b.name, {"rx", "ry", "rz"}, "m", "position of the centre of mass, global frame");
        add(b.name, {"A11", "A12", "A13", "A21", "A22", "A23", "A31", "A32", "A33"}, "1",
            "rotation matrix from the body frame to the global frame");
        add(b.name, {"vx", "vy", "vz"}, "m/s", "velocity of the centre of mass, global frame");
        add(b.name, {"wx", "wy", "wz"}, "rad/s", "angular velocity, body frame");
        add(b.name, {"ax", "ay", "az"}, "m/s^2", "acceleration of the centre of mass, global frame");
        add(b.name, {"alx", "aly", "alz"}, "rad/s^2", "angular acceleration, body frame");
    }
    return all;
}

class BodyColumns final : public ColumnGroup {
public:
    explicit BodyColumns(const dae::Model& model) : ColumnGroup(columns_of_bodies(model)) {}

    void values(const lie::State& x, double* out) override
    {
        const auto add = [&](const lie::Vec3& v) {
            for (const double component : v) *out++ = component;
        };
        for (const lie::Motion& body : x.body) {
            add(body.r);
            for (int i = 0; i < 3; ++i) add(body.A.row(i).transpose());
            add(body.rdot), add(body.omega_bar), add(body.rddot), add(body.omegadot_bar);
        }
    }
};

std::vector<dae::Quantity> columns_of_forces(const dae::Model& model)
{
    std::vector<dae::Quantity> all;
    for (const auto& force : model.forces())
        for (const dae::Quantity& q : force->quantities())
            all.push_back({force->name + '.' + q.name, q.unit, q.meaning});
    return all;
}

class ForceColumns final : public ColumnGroup {
public:
    explicit ForceColumns(const dae::Model& model) : ColumnGroup(columns_of_forces(model))
    {
        for (const auto& force : model.forces())
            if (const size_t count = force->quantities().size(); count > 0)
                forces.emplace_back(force.get(), count);
    }

    void values(const lie::State& x, double* out) override
    {
        for (const auto& [force, count] : forces) {
            force->values(x, out);
            out += count;
        }
    }

private:
    std::vector<std::pair<const dae::Force*, size_t>> forces;  ///< with the number of columns
};

}  // namespace

std::unique_ptr<ColumnGroup> body_columns(const dae::Model& model)
{
    return std::make_unique<BodyColumns>(model);
}

std::unique_ptr<ColumnGroup> force_columns(const dae::Model& model)
{
    return std::make_unique<ForceColumns>(model);
}

ColumnsSink::ColumnsSink(const RunSetup& run, const std::string& name, std::unique_ptr<ColumnGroup> group)
    : TableSink(run, name), warn(run.warn), group(std::move(group))
{}

std::vector<TableColumn> ColumnsSink::columns() const
{
    std::vector<TableColumn> all = {time_column};
    run::append(all, group->columns);
    return all;
}

void ColumnsSink::append(std::vector<double>& row, const RunNode& node)
{
    if (!node.is_row) return;
    row.resize(1 + group->columns.size());
    row[0] = node.x.t;
    group->values(node.x, row.data() + 1);
    for (size_t k = 1; k < row.size(); ++k) {
        if (std::isnan(row[k])) row[k] = std::abs(row[k]);  // nan without a sign
        if (std::isfinite(row[k]) || has_warned) continue;
        has_warned = true;
        if (warn)
            warn(fmt::format("{}: {} is not finite at t = {:.6g} s", label(), group->columns[k - 1].name,
                             node.x.t));
    }
}

}  // namespace hilda::run
