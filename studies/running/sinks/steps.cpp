// SPDX-License-Identifier: GPL-3.0-or-later
/// steps.csv: Newton iterations, residuals, energy and cost of each step.

#include "io/csv.hpp"
#include "studies/running/sink.hpp"

namespace hilda::studies {

namespace {

class Steps final : public RowsSink {
public:
    explicit Steps(const RunSetup& run) : RowsSink(run.directory, "steps.csv"), h(run.grid.h) {}

private:
    std::string header() const override
    {
        return "t,h,newton_iterations,correction,constraint_norm,energy,factorizations,wall_ns\n";
    }

    void append(std::string& row, const RunNode& node) override
    {
        if (node.n == 0) return;
        const auto field = [&](auto value) {
            io::append_number(row, value);
            row += ',';
        };
        field(node.x.t);
        field(h);
        field(static_cast<long>(node.iterations));
        field(node.cost.correction);
        field(node.constraint_norm);
        field(node.energy);
        field(node.cost.factorizations);
        io::append_number(row, node.cost.wall_ns);
        row += '\n';
    }

    const double h;
};

const bool registered = io::Registry<SinkType>::add(
    {.name = "steps",
     .options = {{.name = "--log-steps", .help = "write steps.csv as well, a row for each step"}},
     .make = [](const RunSetup& run) -> std::unique_ptr<io::Sink<RunNode>> {
         if (!run.options.contains("--log-steps")) return nullptr;
         return std::make_unique<Steps>(run);
     },
     .files = {"steps.csv"}});

}  // namespace

}  // namespace hilda::studies
