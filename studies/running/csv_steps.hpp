// SPDX-License-Identifier: GPL-3.0-or-later
/// steps.csv: Newton iterations, residuals, energy and cost of each step.

#pragma once

#include "io/output_file.hpp"
#include "lie/trajectory.hpp"

#include <chrono>

namespace hilda::lie {
class Integrator;
}

namespace hilda::dae {
class Model;
}

namespace hilda::studies {

class StepsCsv final : public lie::Observer {
public:
    using Clock = std::chrono::steady_clock;

    StepsCsv(const dae::Model& model, const lie::Integrator& integrator, double h, io::OutputFile& file)
        : model(model), integrator(integrator), h(h), file(file)
    {}

    /// Writes the names of the columns.
    void write_header();
    /// Resets the counters. To be called directly before the time integration starts.
    void begin();
    void accepted(const lie::State& x, long n, int iterations) override;

    /// Cost of the step that ends at the current node. Its row is written after the following step, because
    /// schemes with staggered velocities fill the node only then.
    struct Cost {
        long factorizations = 0, wall_ns = 0;
        double correction = 0;  ///< norm of the last Newton correction
    } last;

private:
    const dae::Model& model;
    const lie::Integrator& integrator;
    const double h;
    io::OutputFile& file;
    long factorizations = 0;
    Clock::time_point since;
};

}  // namespace hilda::studies
