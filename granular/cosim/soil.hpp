// SPDX-License-Identifier: GPL-3.0-or-later
/// A case as the grains of a co-simulation, in the same process.

#pragma once

#include "granular/cosim/exchange.hpp"
#include "granular/running/run.hpp"

namespace hilda::granular {

class Soil final : public Exchange {
public:
    /// A run with the boundaries of these names as tools. Throws io::InvalidInput "tool 'NAME': ..." for a
    /// name that no boundary has, for a part of another boundary, and for a boundary with a prescribed motion
    /// or load.
    Soil(const RunOptions& options, Continuation run, const std::vector<std::string>& names);

    /// Inserts the particles without a run, for stiffness(). open() must not be called then.
    void insert() const { insert_particles(given.c); }
    World& world() const { return run ? *run->case_of_run().world : *given.c.world; }
    const std::vector<std::string>& notices() const { return given.c.notices; }  ///< before open()

    double h() const override { return step; }
    const std::vector<Tool>& tools() const override { return all; }
    void open(const std::vector<ToolBody>& bodies, long steps) override;
    std::vector<ToolImpulse> loads(const std::vector<ToolMotion>& motions) override;
    void advance(const std::vector<ToolMotion>& motions, long number, std::vector<ToolImpulse>& to) override;
    void stiffness(std::vector<ToolStiffness>& to) override;
    void save() override { run->save(); }
    void close(int code) override { run->close(code); }

private:
    void place(const std::vector<ToolMotion>& motions) const;
    /// Loads on tool k about its centre of mass, with the place that it had when they were computed
    Wrench about_centre(std::size_t k, const Wrench& load, const EulerParameters<double>& p) const;

    RunOptions options;
    Continuation given;  ///< until the run is open
    double step;         ///< [s]
    std::unique_ptr<SteppedRun> run;
    std::vector<Tool> all;
    std::vector<int> number;      ///< of the boundary of each tool
    std::vector<double> single;   ///< ToolStiffness::single of each tool, once it is known
    std::vector<double> present;  ///< stiffness of each boundary
    std::vector<ToolBody> body;
    std::vector<EulerParameters<double>> frame;  ///< Boundary::p of each tool at the beginning of a step
};

}  // namespace hilda::granular
