// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/cosim/grain_coupling.hpp"

#include "dae/model_file.hpp"
#include "io/error.hpp"
#include "io/nearest.hpp"
#include "lie/euler_parameters.hpp"
#include "lie/trajectory.hpp"
#include "run/cosim/effective_mass.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hilda::run {

namespace {

lie::Vec3 to_lie(const granular::Vec3& a) { return {a.x, a.y, a.z}; }
granular::Vec3 to_granular(const lie::Vec3& a) { return {a[0], a[1], a[2]}; }

lie::Mat3 to_lie(const granular::EulerParameters<double>& p)
{
    return lie::rotation({p.e0, p.e.x, p.e.y, p.e.z});
}
granular::EulerParameters<double> orientation_of(const lie::Mat3& A)
{
    const lie::Vec4 p = lie::euler_parameters(A);
    return {p[0], {p[1], p[2], p[3]}};
}

Wrench6 wrench(const granular::ToolImpulse& i, double time)
{
    Wrench6 w;
    w << to_lie(i.P) / time, to_lie(i.L) / time;
    return w;
}

}  // namespace

GrainCoupling::GrainCoupling(const CosimFile& file, std::unique_ptr<granular::Exchange> of)
    : file(file), grains(std::move(of)), h(grains->h()), k(file.substeps)
{}

void GrainCoupling::find_bodies(const dae::Description& d)
{
    model = d.model.get();
    const std::vector<dae::Body>& bodies = model->all_bodies();
    std::vector<std::string> names;
    for (const dae::Body& body : bodies) names.push_back(body.name);
    for (const CosimPair& pair : file.pairs) {
        const auto found = std::find(names.begin(), names.end(), pair.body);
        if (found == names.end())
            throw io::InvalidInput(pair.place + ": no body of " + file.model + " has the name" +
                                   io::with_nearest(pair.body, names));
        const int body = static_cast<int>(found - names.begin());
        const std::size_t j = all.size();
        all.push_back({.name = pair.body, .body = body});
        mass.push_back(bodies[static_cast<size_t>(body)].m);
        frame.emplace_back(d.x.body[static_cast<size_t>(body)].A.transpose() *
                           to_lie(grains->tools()[j].place.p));
        check_tool(j, d);
    }
}

void GrainCoupling::prepare(dae::Description& d, std::optional<long> node)
{
    find_bodies(d);
    warned.assign(all.size(), false);
    std::vector<granular::ToolBody> bodies;
    for (std::size_t j = 0; j < all.size(); ++j)
        bodies.push_back({mass[j], to_granular(lie::Vec3(-(frame[j].transpose() * file.pairs[j].r)))});
    grains->open(bodies, steps_before(node.value_or(0)));
    motions.resize(all.size());
    for (std::size_t j = 0; j < all.size(); ++j) {
        std::function<Wrench6(const dae::State& x)> at_start;
        if (!node) at_start = [this, j](const dae::State& x) { return loads(x)[j]; };
        auto coupled = std::make_unique<CoupledWrench>(all[j].body, "grains on " + all[j].name, at_start);
        force.push_back(coupled.get());
        d.model->load(std::move(coupled));
    }
}

/// Throws io::InvalidInput if the boundary of a tool is not at the place of its body, or has another mass.
void GrainCoupling::check_tool(std::size_t j, const dae::Description& d) const
{
    const granular::Tool& tool = grains->tools()[j];
    const lie::Motion& body = d.x.body[static_cast<size_t>(all[j].body)];
    const lie::Vec3 at = to_lie(tool.place.r), expected = body.r + body.A * file.pairs[j].r;
    // of decimals in the files; without squares, which overflow
    const double rounding = 1e-6 * std::max(at.lpNorm<Eigen::Infinity>(), expected.lpNorm<Eigen::Infinity>());
    if (!((at - expected).lpNorm<Eigen::Infinity>() <= rounding))
        throw io::InvalidInput(fmt::format(
            "{}: boundary '{}' is at ({:.9g}, {:.9g}, {:.9g}) m in the case, but body '{}' starts with it at "
            "({:.9g}, {:.9g}, {:.9g}) m; r of the pair is the place of the boundary relative to the centre "
            "of mass",
            file.pairs[j].place, tool.name, at[0], at[1], at[2], all[j].name, expected[0], expected[1],
            expected[2]));
    if (tool.mass > 0 && !(std::abs(tool.mass - mass[j]) <= 1e-9 * mass[j]))
        throw io::InvalidInput(
            fmt::format("{}: boundary '{}' has the mass {:.9g} kg, body '{}' has {:.9g} kg",
                        file.pairs[j].place, tool.name, tool.mass, all[j].name, mass[j]));
}

/// Velocities (ṙ, ω̄) of a body half a step before the node
Vec6 GrainCoupling::velocity(const lie::State& x, int body) const
{
    if (x.history.size() >= 6 * (body + 1)) return x.history.segment<6>(6 * body);
    const lie::Motion& b = x.body[static_cast<size_t>(body)];
    Vec6 v;
    v << b.rdot - 0.5 * H() * b.rddot, b.omega_bar - 0.5 * H() * b.omegadot_bar;
    return v;
}

/// Sets the places and velocities of the tools a time after the node, with the velocities half a step before
/// it.
void GrainCoupling::set_motions(const lie::State& x, double time)
{
    for (std::size_t j = 0; j < all.size(); ++j) {
        const lie::Motion& b = x.body[static_cast<size_t>(all[j].body)];
        const Vec6 v = velocity(x, all[j].body);
        const lie::Mat3 A = b.A * lie::exp(lie::Vec3(time * v.tail<3>()));
        const lie::Vec3 d = A * file.pairs[j].r, omega = A * v.tail<3>();
        motions[j] = {.r = to_granular(b.r + time * v.head<3>() + d),
                      .p = orientation_of(A * frame[j]),
                      .v = to_granular(v.head<3>() + omega.cross(d)),
                      .omega = to_granular(omega)};
    }
}

std::vector<Wrench6> GrainCoupling::loads(const lie::State& x)
{
    std::vector<Wrench6> to;
    set_motions(x, 0);
    for (const granular::ToolImpulse& i : grains->loads(motions)) to.push_back(wrench(i, 1));
    return to;
}

void GrainCoupling::begin(const lie::March& march, const std::function<void(const std::string&)>& on_warning)
{
    for (CoupledWrench* f : force) f->end_start();
    warn = on_warning;
    analyse(*model);
    grains->stiffness(stiffness);
    if (march.number() == 0) refuse_unstable(stiffness, march.node());
}

double GrainCoupling::stable_step(std::size_t j, double stiffness, const lie::State& x) const
{
    return stiffness > 0 ? 2 * std::sqrt((*effective_mass)(x, all[j].body) / stiffness)
                         : std::numeric_limits<double>::infinity();
}

/// Whether the step is above the stability limit, which is at least that of the free body
bool GrainCoupling::is_unstable(std::size_t j, double stiffness, const lie::State& x) const
{
    return H() * H() * stiffness > 4 * mass[j] && H() > stable_step(j, stiffness, x);
}

void GrainCoupling::refuse_unstable(const std::vector<granular::ToolStiffness>& of, const lie::State& x) const
{
    for (std::size_t j = 0; j < all.size(); ++j) {
        const auto refuse = [&](double K, const std::string& contacts) {
            if (!is_unstable(j, K, x)) return;
            throw io::InvalidInput(fmt::format(
                "{}: the step H = {:.4g} s of the mechanism must be at most {:.3g} s, the stability limit of "
                "body '{}' on {} with {:.3g} N/m; reduce substeps",
                file.pairs[j].place, H(), stable_step(j, K, x), all[j].name, contacts, K));
        };
        refuse(of[j].single, fmt::format("one contact with an overlap of {} % of the radius",
                                         100 * granular::ToolStiffness::single_overlap));
        refuse(of[j].present, "its contacts at the start");
    }
}

/// Warns once of each body whose contacts have become too stiff for the step.
void GrainCoupling::check_stability(const lie::State& x)
{
    grains->stiffness(stiffness);
    for (std::size_t j = 0; j < all.size(); ++j) {
        const double K = stiffness[j].present;
        if (warned[j] || !is_unstable(j, K, x)) continue;
        warned[j] = true;
        warn(fmt::format(
            "the step {:.4g} s of the mechanism is above {:.3g} s, the stability limit of body '{}' "
            "on the contacts of '{}' with {:.3g} N/m at t = {:.6g} s; reduce substeps",
            H(), stable_step(j, K, x), all[j].name, grains->tools()[j].name, K, x.t));
    }
}

void GrainCoupling::before_step(lie::March& march)
{
    if (march.number() % nodes_between_checks == 0) check_stability(march.node());
    const long n = march.number(), before = n == 0 ? 0 : (k - 1) / 2, steps = n == 0 ? k / 2 + 1 : k;
    set_motions(march.node(), -static_cast<double>(before) * h);
    grains->advance(motions, steps, impulses);
    for (std::size_t j = 0; j < all.size(); ++j) {
        const auto first = static_cast<size_t>(force[j]->first_internal_state);
        const granular::ToolImpulse& i = impulses[j];
        const Wrench6 total = wrench(i, 1),
                      shared = (k % 2 == 0 ? 0.5 : 0.) * wrench({.P = i.P_last, .L = i.L_last}, 1),
                      earlier = Eigen::Map<const Wrench6>(march.node().internal_state.data() + first + 6),
                      at_start = Eigen::Map<const Wrench6>(march.node().internal_state.data() + first);
        Eigen::Matrix<double, 12, 1> now;
        now << (earlier + total - shared) / H(), shared;
        // The start has removed half a step of its loads from the momenta. The grains have no half step.
        if (n == 0) now.head<6>() += (0.5 * H() - 0.5 * h) / H() * at_start;
        march.set_internal_states(first, {now.data(), 12});
        CoupledTool& tool = all[j];
        const Wrench6 impulse = H() * now.head<6>();
        tool.P = impulse.head<3>(), tool.L = impulse.tail<3>(), tool.work = i.work;
        tool.acts = true;
    }
}

void GrainCoupling::before_finish()
{
    for (CoupledTool& tool : all) tool.acts = false;
}

void GrainCoupling::close(int code)
{
    try {
        grains->close(code);
    } catch (const io::NumericalFailure&) {
        // After a failure the grains may have ended already.
        if (code == io::exit_code::done) throw;
    }
}

}  // namespace hilda::run
