// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/running/csv_steps.hpp"

#include "dae/model.hpp"
#include "io/csv.hpp"
#include "lie/integrator.hpp"

namespace hilda::studies {

void StepsCsv::write_header()
{
    file.buffer += "t,h,newton_iterations,correction,constraint_norm,energy,factorizations,wall_ns\n";
}

void StepsCsv::begin()
{
    factorizations = integrator.statistics().factorizations;
    since = Clock::now();
}

void StepsCsv::accepted(const lie::State& x, long n, int iterations)
{
    const Clock::time_point now = Clock::now();
    if (n > 0) {
        std::string& row = file.buffer;
        const auto field = [&](auto value) {
            io::append_number(row, value);
            row += ',';
        };
        field(x.t);
        field(h);
        field(static_cast<long>(iterations));
        field(last.correction);
        field(model.largest_residual(x).value);
        field(lie::energy(model, x));
        field(last.factorizations);
        io::append_number(row, last.wall_ns);
        row += '\n';
        file.flush_when_full();
    }
    // lie::March reports a node after the following step; the counters since the last call are those of that
    // step.
    const long counted = integrator.statistics().factorizations;
    last = {counted - factorizations, std::chrono::nanoseconds(now - since).count(),
            integrator.statistics().correction};
    factorizations = counted;
    since = Clock::now();
}

}  // namespace hilda::studies
