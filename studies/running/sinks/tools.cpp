// SPDX-License-Identifier: GPL-3.0-or-later
/// Table tools of a co-simulation: pose, loads and powers of the bodies on which the other side acts, at the
/// output rows.

#include "lie/euler_parameters.hpp"
#include "studies/running/coupling.hpp"
#include "studies/running/tables/table_sink.hpp"

namespace hilda::studies {

namespace {

class Tools final : public TableSink {
public:
    explicit Tools(const RunSetup& run)
        : TableSink(run, "tools"), coupling(*run.coupling), H(run.grid.h), error(coupling.tools().size(), 0)
    {}

    void transfer(io::Archive& a) override
    {
        TableSink::transfer(a);
        a.list(error);
    }

private:
    std::vector<TableColumn> columns() const override
    {
        std::vector<TableColumn> all = {time_column};
        for (const CoupledTool& tool : coupling.tools()) {
            const auto add = [&](const char* what, const char* unit, const std::string& text) {
                all.push_back({tool.name + '.' + what, unit, text});
            };
            for (const char* r : {"x", "y", "z"})
                add(r, "m", std::string("place of the centre of mass, ") + r);
            for (const char* e : {"e0", "e1", "e2", "e3"}) add(e, "", "Euler parameter of the orientation");
            for (const char* F : {"Fx", "Fy", "Fz"}) add(F, "N", "mean force on the body, global frame");
            for (const char* T : {"Tx", "Ty", "Tz"})
                add(T, "N m", "mean torque about the centre of mass, global frame");
            add("power", "W", "power of the loads on the body, with the velocity of the body");
            add("power_grains", "W", "the same with the velocity that the grains have seen");
            add("energy_error", "J", "time integral of power - power_grains from the start");
        }
        return all;
    }

    void append(std::vector<double>& row, const RunNode& node) override
    {
        if (node.is_row) row.push_back(node.x.t);
        for (std::size_t k = 0; k < error.size(); ++k) {
            const CoupledTool& tool = coupling.tools()[k];
            const lie::Motion& b = node.x.body[static_cast<size_t>(tool.body)];
            const double work = tool.P.dot(b.rdot) + tool.L.dot(b.A * b.omega_bar);
            error[k] += work - tool.work;
            if (!node.is_row) continue;
            studies::append(row, b.r);
            const lie::Vec4 p = lie::euler_parameters(b.A);
            row.insert(row.end(), p.begin(), p.end());
            studies::append(row, tool.F), studies::append(row, tool.T);
            row.insert(row.end(), {work / H, tool.work / H, error[k]});
        }
    }

    const Coupling& coupling;
    const double H;             ///< step of the mechanism [s]
    std::vector<double> error;  ///< of each tool [J]
};

const bool registered =
    io::Registry<SinkType>::add({.name = "tools",
                                 .make = [](const RunSetup& run) -> std::unique_ptr<io::Sink<RunNode>> {
                                     if (run.coupling == nullptr) return nullptr;
                                     return std::make_unique<Tools>(run);
                                 },
                                 .files = {"tools.csv"}});

}  // namespace

}  // namespace hilda::studies
