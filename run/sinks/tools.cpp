// SPDX-License-Identifier: GPL-3.0-or-later
/// Table tools of a co-simulation: pose, loads and powers of the bodies on which the other side acts, at the
/// output rows.

#include "lie/euler_parameters.hpp"
#include "run/recording/coupling.hpp"
#include "run/tables/table_sink.hpp"

namespace hilda::run {

namespace {

class Tools final : public TableSink {
public:
    explicit Tools(const RunSetup& run)
        : TableSink(run, "tools"), coupling(*run.coupling), H(run.grid.h), sums(coupling.tools().size())
    {}

    void transfer(io::Archive& a) override
    {
        TableSink::transfer(a);
        a.list(sums);
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
            for (const char* F : {"Fx", "Fy", "Fz"})
                add(F, "N", "force on the body, mean since the previous row, global frame");
            for (const char* T : {"Tx", "Ty", "Tz"})
                add(T, "N m", "torque about the centre of mass, mean since the previous row, global frame");
            add("power", "W", "power of the loads on the body, mean since the previous row");
            add("power_grains", "W", "the same with the velocity that the grains have seen");
            add("work", "J", "time integral of power from the start");
            add("energy_error", "J", "time integral of power - power_grains from the start");
        }
        return all;
    }

    void append(std::vector<double>& row, const RunNode& node) override
    {
        if (node.is_row) row.push_back(node.x.t);
        for (std::size_t k = 0; k < sums.size(); ++k) {
            const CoupledTool& tool = coupling.tools()[k];
            const lie::Motion& b = node.x.body[static_cast<size_t>(tool.body)];
            Sums& sum = sums[k];
            if (tool.acts) {
                const double work = tool.P.dot(b.rdot) + tool.L.dot(b.A * b.omega_bar);
                sum.P += tool.P, sum.L += tool.L;
                sum.work += work, sum.work_grains += tool.work;
                sum.total_work += work, sum.error += work - tool.work;
                sum.exchanges += 1;
            }
            if (!node.is_row) continue;
            run::append(row, b.r);
            const lie::Vec4 p = lie::euler_parameters(b.A);
            row.insert(row.end(), p.begin(), p.end());
            if (sum.exchanges > 0) {  // otherwise the loads of the previous row remain
                const double time = H * sum.exchanges;
                sum.F = sum.P / time, sum.T = sum.L / time;
                sum.power = sum.work / time, sum.power_grains = sum.work_grains / time;
            }
            run::append(row, sum.F), run::append(row, sum.T);
            row.insert(row.end(), {sum.power, sum.power_grains, sum.total_work, sum.error});
            sum.P.setZero(), sum.L.setZero(), sum.work = sum.work_grains = sum.exchanges = 0;
        }
    }

    struct Sums {
        // since the previous row
        lie::Vec3 P = lie::Vec3::Zero(), L = lie::Vec3::Zero();  ///< [N s], [N m s]
        double work = 0, work_grains = 0;                        ///< [J]
        double exchanges = 0;
        // of the last row
        lie::Vec3 F = lie::Vec3::Zero(), T = lie::Vec3::Zero();  ///< [N], [N m]
        double power = 0, power_grains = 0;                      ///< [W]
        // since the start
        double total_work = 0, error = 0;  ///< [J]
    };

    const Coupling& coupling;
    const double H;          ///< step of the mechanism [s]
    std::vector<Sums> sums;  ///< of each tool
};

const bool registered_tools =
    io::Registry<SinkType>::add({.name = "tools",
                                 .make = [](const RunSetup& run) -> std::unique_ptr<io::Sink<RunNode>> {
                                     if (run.coupling == nullptr) return nullptr;
                                     return std::make_unique<Tools>(run);
                                 },
                                 .files = {"tools.csv"}});

}  // namespace

}  // namespace hilda::run
