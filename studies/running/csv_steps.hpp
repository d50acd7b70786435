// SPDX-License-Identifier: GPL-3.0-or-later
/// steps.csv: what each step did and cost.

#pragma once

#include "dae/model.hpp"
#include "lie/trajectory.hpp"
#include "studies/output_file.hpp"

#include <chrono>

namespace hilda::studies {

class StepsCsv final : public lie::Observer {
public:
    using Clock = std::chrono::steady_clock;

    StepsCsv(const dae::Model& model, const lie::Integrator& integrator, double h, OutputFile& file)
        : model(model), integrator(integrator), h(h), file(file)
    {}

    void write_header();
    /// Counts from here: called just before the march sets off.
    void begin();
    void accepted(const lie::State& x, long n, int iterations) override;

    /// Factorizations and duration of the step that led to the node the march stands on. Its line is written
    /// when the march leaves that node, for only then is the node known in full.
    struct Cost {
        long factorizations = 0, wall_ns = 0;
        double correction = 0;  ///< last one of the step
    } last;

private:
    const dae::Model& model;
    const lie::Integrator& integrator;
    const double h;
    OutputFile& file;
    long factorizations = 0;
    Clock::time_point since;
};

}  // namespace hilda::studies
