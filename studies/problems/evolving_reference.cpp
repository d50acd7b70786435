// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/problems/evolving_reference.hpp"

#include "contact/evolving/unilateral.hpp"
#include "contact/surfaces/ellipsoid.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"
#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "lie/steps/accelerations.hpp"
#include "reference/motions/ball_in_bowl.hpp"
#include "reference/motions/ellipsoid_on_plane.hpp"
#include "run/columns/contact_rows.hpp"
#include "run/watch/run_check.hpp"
#include "run/watch/watch.hpp"

#include <algorithm>

namespace hilda::studies {

namespace {

using contact::EvolvingContact;
using lie::Mat3;
using lie::Vec3;
using reference::ContactInstant;

constexpr double small_step = 1e-4;  // [s]
/// Largest accepted difference between the start of the model and that of the minimal coordinates [m, m/s,
/// rad/s]
constexpr double start_tolerance = 1e-12;

bool has_body_frame(const contact::Shape& s) { return s.position.isZero(0) && s.orientation.isIdentity(0); }

template <class Surface>
const Surface* surface(const contact::Shape& s)
{
    return dynamic_cast<const Surface*>(s.surface.get());
}

double distance(const lie::Motion& a, const lie::Motion& b)
{
    return (a.r - b.r).norm() + (a.A - b.A).norm() + (a.rdot - b.rdot).norm() +
           (a.omega_bar - b.omega_bar).norm();
}

/// The contact of body 0 with the ground if the model consists of one body, this contact and gravity along
/// -z; nullptr otherwise
const EvolvingContact* only_contact(const dae::Model& model)
{
    const auto contacts = run::evolving_contacts(model);
    if (model.bodies() != 1 || contacts.size() != 1 || model.general_constraints().size() != 1 ||
        model.rows() > 9 || !model.forces().empty() || !model.all_rows().empty() ||
        contacts[0]->j != dae::ground)
        return nullptr;
    if (model.gravity.x() != 0 || model.gravity.y() != 0 || !(model.gravity.z() < 0)) return nullptr;
    if (!has_body_frame(contacts[0]->shape_i) || !has_body_frame(contacts[0]->shape_j)) return nullptr;
    return contacts[0];
}

/// Solution for a ball in an ellipsoidal bowl; empty for any other model
std::vector<ContactInstant> ball_in_bowl(const dae::Description& d, const EvolvingContact& c,
                                         const std::vector<double>& instants)
{
    const auto* ball = surface<contact::Sphere>(c.shape_i);
    const auto* bowl = surface<contact::Ellipsoid>(c.shape_j);
    const Mat3& J_bar = d.model->mass().J_bar[0];
    if (ball == nullptr || bowl == nullptr || ball->sigma() < 0 || bowl->sigma() > 0 ||
        !J_bar.isApprox(J_bar(0, 0) * Mat3::Identity(), 1e-14))
        return {};
    const lie::Motion& start = d.x.body[0];
    const reference::BallInBowl problem{.semi_axes = bowl->semi_axes,
                                        .R = ball->R,
                                        .m = d.model->mass().m[0],
                                        .J = J_bar(0, 0),
                                        .g = -d.model->gravity.z()};
    const Vec3 p = Vec3::Map(d.x.alpha.data() + 3);
    const reference::BallInBowl::InitialState start_state{
        .p = p, .rdot = start.rdot, .spin = problem.normal(p).dot(start.A * start.omega_bar), .A = start.A};
    return c.friction == EvolvingContact::Friction::rolling ? problem.roll(start_state, instants)
                                                            : problem.slide(start_state, instants);
}

/// Solution for an ellipsoid on a plane; empty for any other model
std::vector<ContactInstant> ellipsoid_on_plane(const dae::Description& d, const EvolvingContact& c,
                                               const std::vector<double>& instants)
{
    const auto* ellipsoid = surface<contact::Ellipsoid>(c.shape_i);
    if (ellipsoid == nullptr || ellipsoid->sigma() < 0 || surface<contact::Plane>(c.shape_j) == nullptr)
        return {};
    const lie::Motion& start = d.x.body[0];
    const reference::EllipsoidOnPlane problem{.semi_axes = ellipsoid->semi_axes,
                                              .m = d.model->mass().m[0],
                                              .J_bar = d.model->mass().J_bar[0],
                                              .g = -d.model->gravity.z()};
    const reference::EllipsoidOnPlane::InitialState start_state{.A = start.A,
                                                                .omega_bar = start.omega_bar,
                                                                .x = start.r.x(),
                                                                .y = start.r.y(),
                                                                .xdot = start.rdot.x(),
                                                                .ydot = start.rdot.y()};
    return c.friction == EvolvingContact::Friction::rolling ? problem.roll(start_state, instants)
                                                            : problem.slide(start_state, instants);
}

/// Solution in minimal coordinates; empty if the model is not covered or its start differs
std::vector<ContactInstant> minimal_coordinate_solution(const dae::Description& d,
                                                        std::vector<double> instants)
{
    const EvolvingContact* c = only_contact(*d.model);
    if (c == nullptr || d.x.t != 0) return {};
    instants.insert(instants.begin(), 0.0);
    try {
        std::vector<ContactInstant> all = ball_in_bowl(d, *c, instants);
        if (all.empty()) all = ellipsoid_on_plane(d, *c, instants);
        if (all.empty() || !(distance(all.front().body, d.x.body[0]) <= start_tolerance)) return {};
        all.erase(all.begin());
        return all;
    } catch (const lie::InvalidInput&) {  // the start is outside the range of the minimal coordinates
    } catch (const lie::NumericalFailure&) {
    }
    return {};
}

}  // namespace

lie::Trajectory evolving_reference(dae::Description& d, const std::vector<double>& instants)
{
    const std::vector<ContactInstant> exact = minimal_coordinate_solution(d, instants);
    if (exact.empty()) return run_with_small_steps(d, instants, lie::scheme("rA-rkmk-4"), small_step);
    lie::Saddle K(*d.model);
    lie::Trajectory run;
    for (const ContactInstant& at : exact) {
        lie::State x = d.x;
        x.t = at.t;
        x.body[0] = at.body;
        x.alpha << at.a_bar, at.p;
        d.model->set_internal_state_at_start(x);
        lie::solve_accelerations(*d.model, K, x);  // sets the multipliers
        run.row.push_back(std::move(x));
    }
    return run;
}

lie::Trajectory run_with_small_steps(const dae::Description& d, const std::vector<double>& instants,
                                     const lie::Scheme& scheme, double h)
{
    const auto integrator = contact::make_integrator(*d.model, scheme, {.tolerance = 1e-13});
    lie::Saddle K(*d.model);
    lie::Trajectory run;
    lie::State x = d.x;
    // The steps between two instants have their own length, and one integrator computes them all: the checks
    // of run::Simulation without its grid
    lie::TimeGrid grid = lie::TimeGrid::over(instants.empty() ? 0 : instants.back(), h);
    grid.interval = std::max(1L, grid.steps);
    run::check_run(*d.model, x, scheme, grid, false);
    run::Watch watch(*d.model, x, *integrator, scheme, grid, run::Watch::Action::stop);
    lie::Observer* observers[] = {&watch};
    for (const double instant : instants) {
        const double steps = std::ceil((instant - x.t) / h - 1e-6);
        if (steps > 0) {
            lie::March march(x, *integrator, (instant - x.t) / steps);
            while (march.number() < static_cast<long>(steps)) march.advance(observers);
            x = march.node();
            x.t = instant;
        }
        lie::solve_accelerations(*d.model, K, x);
        run.row.push_back(x);
    }
    return run;
}

}  // namespace hilda::studies
