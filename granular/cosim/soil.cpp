// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/cosim/soil.hpp"

#include "io/error.hpp"
#include "io/nearest.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

Soil::Soil(const RunOptions& options, Continuation run_of, const std::vector<std::string>& names)
    : options(options), given(std::move(run_of)), step(given.c.h)
{
    const Case& c = given.c;
    for (const std::string& name : names) {
        const auto fail = [&](const std::string& what) {
            throw io::InvalidInput(options.file + ": tool '" + name + "': " + what);
        };
        const auto found = std::find(c.boundaries.begin(), c.boundaries.end(), name);
        if (found == c.boundaries.end())
            fail("no boundary of the case has this name" + io::with_nearest(name, c.boundaries));
        const auto k = static_cast<int>(found - c.boundaries.begin());
        const Boundary& b = c.world->all_boundaries()[static_cast<std::size_t>(k)];
        if (b.body >= 0) fail("is a part of another boundary; name its body");
        for (const BoundaryMotion& m : *c.motions)
            if (m.boundary == k)
                fail("must have no formulas of r, v, omega, F and T, because the mechanism moves it");
        number.push_back(k);
        all.push_back({.name = name, .mass = b.mass, .place = {b.r, b.p, b.v, b.omega}});
    }
    if (c.world->scheme() == Scheme::velocity_verlet)
        throw io::InvalidInput(options.file +
                               ": a co-simulation needs an integrator with one evaluation of the "
                               "loads at the beginning of a step, got velocity-verlet");
}

void Soil::open(const std::vector<ToolBody>& bodies, long steps)
{
    body = bodies;
    World& world = *given.c.world;
    for (std::size_t k = 0; k < number.size(); ++k) {
        Boundary& b = world.boundary(number[k]);
        b.free.fill(false);
        b.F = b.T = {0, 0, 0};
        // Part of the damping of the contacts. The loads of boundaries without a mass are not computed.
        for (int j = 0; j < static_cast<int>(world.all_boundaries().size()); ++j)
            if (j == number[k] || world.all_boundaries()[static_cast<std::size_t>(j)].body == number[k])
                world.boundary(j).mass = body[k].mass;
    }
    // Without a checkpoint of the mechanism both sides start again.
    if (options.resume && steps == 0) options.resume = false, options.force = true;
    run = SteppedRun::open(options, std::move(given), options.resume ? steps : -1);
}

void Soil::place(const std::vector<ToolMotion>& motions) const
{
    for (std::size_t k = 0; k < number.size(); ++k) {
        const ToolMotion& m = motions[k];
        world().set_place(number[k], m.r, m.p);
        Boundary& b = world().boundary(number[k]);
        b.v = m.v, b.omega = m.omega;
    }
}

Wrench Soil::about_centre(std::size_t k, const Wrench& load, const EulerParameters<double>& p) const
{
    return {load.F, load.T - rotated(p, body[k].centre).cross(load.F)};
}

std::vector<ToolImpulse> Soil::loads(const std::vector<ToolMotion>& motions)
{
    place(motions);
    const World::Totals totals = world().totals();
    std::vector<ToolImpulse> to;
    for (std::size_t k = 0; k < number.size(); ++k) {
        const Wrench w =
            about_centre(k, totals.on_boundary[static_cast<std::size_t>(number[k])], motions[k].p);
        to.push_back({.P = w.F, .L = w.T});
    }
    return to;
}

void Soil::advance(const std::vector<ToolMotion>& motions, long steps, std::vector<ToolImpulse>& to)
{
    place(motions);
    to.assign(number.size(), {});
    frame.resize(number.size());
    const double h = step;
    for (long j = 0; j < steps; ++j) {
        for (std::size_t k = 0; k < number.size(); ++k) frame[k] = world().boundary(number[k]).p;
        run->step();
        for (std::size_t k = 0; k < number.size(); ++k) {
            const Wrench load = world().tool_load(number[k]), w = about_centre(k, load, frame[k]);
            to[k].P_last = h * w.F, to[k].L_last = h * w.T;
            to[k].P += to[k].P_last, to[k].L += to[k].L_last;
            to[k].work += h * (load.F.dot(motions[k].v) + load.T.dot(motions[k].omega));
        }
    }
}

void Soil::stiffness(std::vector<ToolStiffness>& to)
{
    const std::vector<Boundary>& all_boundaries = world().all_boundaries();
    if (single.empty())
        for (const int k : number) {
            double largest = 0;  // of the body and of its parts
            for (int j = 0; j < static_cast<int>(all_boundaries.size()); ++j) {
                const Boundary& b = all_boundaries[static_cast<std::size_t>(j)];
                if ((j == k || b.body == k) && b.shape != Boundary::Shape::none)
                    largest = std::max(largest, world().contact_stiffness(j, ToolStiffness::single_overlap));
            }
            single.push_back(largest);
        }
    world().boundary_stiffness(present);
    to.resize(number.size());
    for (std::size_t k = 0; k < number.size(); ++k)
        to[k] = {.present = present[static_cast<std::size_t>(number[k])], .single = single[k]};
}

}  // namespace hilda::granular
