// SPDX-License-Identifier: GPL-3.0-or-later
/// outflow.csv: the particles that have left the domain, of a case with domain.outflow or domain.lost.

#include "granular/reading/object_reader.hpp"
#include "granular/running/sink.hpp"
#include "io/message.hpp"

namespace hilda::granular {

namespace {

class OutflowRows final : public io::RowsSink<World> {
public:
    explicit OutflowRows(const CaseSetup& run)
        : RowsSink(run.directory, "outflow.csv"), world(*run.c.world), steps(run.steps_in(run.c.interval))
    {}

    long interval() const override { return steps; }
    void node(const World& w) override
    {
        RowsSink::node(w);
        world.clear_removed();
    }
    /// The state of the world does not change here: it may be saved after this call, with the length that the
    /// file had before.
    void close() override
    {
        RowsSink::node(world);
        RowsSink::close();
    }

private:
    std::string header() const override
    {
        return "t,id,side,x,y,z,vx,vy,vz,omega_x,omega_y,omega_z,radius,mass\n";
    }
    void append(std::string& text, const World& w) override
    {
        for (const RemovedParticle& p : w.removed()) {
            const char* side = p.side == RemovedParticle::none ? "removed" : ObjectReader::side_names[p.side];
            text += io::formatted("%.12g,%u,%s", p.t, p.id, side);
            for (const Vec3& a : {p.r, p.v, p.omega}) text += io::formatted(",%.9g,%.9g,%.9g", a.x, a.y, a.z);
            text += io::formatted(",%.9g,%.9g\n", p.radius, p.mass);
        }
    }

    World& world;
    const long steps;
};

const bool registered_outflow =
    io::Registry<SinkType>::add({.name = "outflow",
                                 .make = [](const CaseSetup& run) -> std::unique_ptr<Sink> {
                                     if (!run.c.world->removes()) return nullptr;
                                     return std::make_unique<OutflowRows>(run);
                                 },
                                 .files = {"outflow.csv"}});

}  // namespace

}  // namespace hilda::granular
