// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/friction/tracked_force.hpp"

#include "contact/derivative_check.hpp"
#include "contact/internal_state.hpp"
#include "dae/model.hpp"

namespace hilda::contact {

namespace {

// Relative rounding error of a pose that was converted to other coordinates and back, and of a time. Lengths
// are relative to 1 m plus the distance from the origin, times to 1 s plus the time.
constexpr double same_pose = 1e-12;

/// The internal state of a contact: deflections, last displacement of the contact point relative to each body
/// (its direction determines the curvature of rolling in the dissertation preset), contact frame, and time
struct SavedValues {
    Vec2 S = Vec2::Zero(), Theta_i = Vec2::Zero(), Theta_j = Vec2::Zero();
    Vec2 p_i = Vec2::Zero(), p_j = Vec2::Zero();
    ContactFrame contact_frame = {};
    double Psi = 0, t = 0;
};
static_assert(reals<SavedValues>() == 5 * 2 + 6 * 3 + 2, "SavedValues must not have padding");

/// The discrete state of a contact: one bit per flag, so that 0 is the initial history
int flags_of(const ContactHistory& m)
{
    int flags = m.has_points | m.touching << 1, bit = 2;
    for (const Regime* r :
         {&m.deflections.slide, &m.deflections.roll_i, &m.deflections.roll_j, &m.deflections.spin}) {
        flags |= r->slipping << bit++;
        flags |= !r->damped << bit++;
    }
    return flags;
}

void restore_flags(int flags, ContactHistory& m)
{
    int bit = 0;
    const auto next = [&] { return (flags >> bit++ & 1) != 0; };
    m.has_points = next(), m.touching = next();
    for (Regime* r :
         {&m.deflections.slide, &m.deflections.roll_i, &m.deflections.roll_j, &m.deflections.spin})
        r->slipping = next(), r->damped = !next();
}

/// Adds the force F [N] at the point C [m] and the torque T [N m], all global, to the loads of body b
void add_load(int b, const Vec3& F, const Vec3& C, const Vec3& T, const lie::State& x, lie::Loads& out)
{
    if (b == dae::ground) return;
    const Motion& body = x.body[b];
    out.F[b] += F;
    out.n_bar[b] += body.A.transpose() * ((C - body.r).cross(F) + T);
}

}  // namespace

TrackedForce::TrackedForce(const std::string& name, const dae::Model& model, int i, int j)
    : i(i), j(j), model(model), name_i(model.body_name(i)), name_j(model.body_name(j))
{
    this->name = name;
    if (i == j) lie::reject(label(), "a contact needs two different bodies", "'" + name_i + "' twice");
}

Inertia TrackedForce::inertia(const dae::Model& model, int b)
{
    if (b == dae::ground) return {};
    return {.m = model.mass().m[b], .J_bar = model.mass().J_bar[b]};
}

const FrictionModel& TrackedForce::law() const { return *pair().friction; }

int TrackedForce::flags(const lie::State& x) const { return x.discrete_state[first_discrete_state]; }

void TrackedForce::set_flags(int flags, lie::State& x) const
{
    x.discrete_state[first_discrete_state] = flags;
}

int TrackedForce::internal_states() const { return reals<SavedValues>(); }

ContactHistory TrackedForce::saved_history(const lie::State& x) const
{
    ContactHistory m;
    restore_flags(flags(x), m);
    const auto all = restored<SavedValues>(x.internal_state.data() + first_of_history());
    m.contact_frame = all.contact_frame;
    m.deflections.S = all.S, m.deflections.Theta_i = all.Theta_i, m.deflections.Theta_j = all.Theta_j;
    m.deflections.Psi = all.Psi;
    return m;
}

void TrackedForce::save(const Instant& now, lie::State& x) const
{
    const ContactHistory& m = now.history;
    set_flags(flags_of(m), x);
    const SlidingDisplacement& s = now.contact_state.slip;
    SavedValues all;
    all.S = m.deflections.S, all.Theta_i = m.deflections.Theta_i, all.Theta_j = m.deflections.Theta_j;
    all.Psi = m.deflections.Psi;
    all.contact_frame = m.contact_frame;
    all.t = x.t;
    if (m.touching) all.p_i = components(s.p_i, s.n, s.u), all.p_j = components(s.p_j, s.n, s.u);
    contact::save(all, x.internal_state.data() + first_of_history());
}

ContactState TrackedForce::evaluate(const lie::State& x) const
{
    try {
        return evaluate(x, saved_history(x));
    } catch (const lie::NumericalFailure& e) {
        rethrow(e, x);
    }
}

TrackedForce::Instant TrackedForce::at(const lie::State& x, const ContactState& contact_state,
                                       const ContactHistory& history) const
{
    Instant now{.contact_state = contact_state, .history = history};
    SlidingDisplacement& s = now.contact_state.slip;
    if (now.contact_state.N > 0 && now.history.touching) {
        const auto last = restored<SavedValues>(x.internal_state.data() + first_of_history());
        const double length = same_pose * (1 + now.contact_state.contact_point.C().norm());
        if (std::abs(x.t - last.t) <= same_pose * (1 + std::abs(x.t)) && s.p_i.norm() < length &&
            s.p_j.norm() < length && std::abs(s.psi) < same_pose) {
            const Vec3 n = s.n, u = s.u;
            s = zero_displacement(now.contact_state.contact_point, u);
            s.p_i = tangent(last.p_i, n, u), s.p_j = tangent(last.p_j, n, u);
            now.is_saved = true;
            return now;
        }
    }
    pair().advance(now.contact_state, motion(x, i), motion(x, j), now.history);
    return now;
}

Wrench TrackedForce::load(const Instant& now, const lie::State& x) const
{
    const ContactState& m = now.contact_state;
    if (!(m.N > 0)) return {};
    return pair().load(m, damper_rates(now, x), now.history);
}

Rates TrackedForce::damper_rates(const Instant& now, const lie::State& x) const
{
    return rates(now.contact_state.contact_point, now.contact_state.slip, motion(x, i), motion(x, j));
}

void TrackedForce::add(const lie::State& x, lie::Loads& out) const
{
    if (is_active(x)) add(at(x), x, out);
}

void TrackedForce::add(const Instant& now, const lie::State& x, lie::Loads& out) const
{
    const ContactState& m = now.contact_state;
    if (!(m.N > 0)) return;
    const Wrench w = load(now, x);
    const Vec3 F = applies_normal_force() ? Vec3(m.share * m.N * m.contact_point.n + w.F) : w.F,
               C = m.contact_point.C();
    add_load(i, F, C, w.T_i, x, out);
    add_load(j, -F, C, w.T_j, x, out);
}

Wrench TrackedForce::friction(const Instant& now, const lie::State& x) const
{
    return is_active(x) ? load(now, x) : Wrench();
}

Wrench TrackedForce::friction(const lie::State& x) const { return is_active(x) ? load(at(x), x) : Wrench(); }

double TrackedForce::time_of_history(const lie::State& x) const
{
    return restored<SavedValues>(x.internal_state.data() + first_of_history()).t;
}

void TrackedForce::update_internal_state(lie::State& x) const
{
    if (is_active(x)) save(at(x), x);
}

int TrackedForce::static_springs(const lie::State& x, StaticSpring* out) const
{
    return is_active(x) ? static_springs(at(x), x, out) : 0;
}

int TrackedForce::static_springs(const Instant& now, const lie::State& x, StaticSpring* out) const
{
    const ContactState& m = now.contact_state;
    if (!(m.N > 0)) return 0;
    const StaticSprings law = pair().static_springs(m);
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    const Rates rate = rates(m.contact_point, m.slip, bi, bj);
    const Vec3 &n = m.slip.n, &u = m.slip.u, w = n.cross(u), C = m.contact_point.C();
    const Vec3 s_i = C - bi.r, s_j = C - bj.r, omega_i = bi.A * bi.omega_bar, omega_j = bj.A * bj.omega_bar;
    const Vec3 omega = omega_i - omega_j, ndot = omega_j.cross(n) + m.contact_point.K_j * rate.p_j;
    const auto set = [](StaticSpring& spring, const StaticSprings::Spring& of, int rows) {
        spring = {.row = {}, .rows = of.K > 0 ? rows : 0, .bound = of.bound_s, .bound_of_slip = of.bound_k};
        for (SpringRow& row : spring.row) row.stiffness = of.K;
    };
    // a row of the relative rotation ω_i - ω_j about a vector that moves with the rate adot
    const auto rotation = [&](SpringRow& row, const Vec3& a, const Vec3& adot) {
        row.pi_i = bi.A.transpose() * a, row.pi_j = -(bj.A.transpose() * a);
        row.gamma = omega.dot(adot);
    };

    // A body that rolls in spite of its rolling resistance is usual: no warning.
    set(out[0], law.slide, 2);
    out[0].name = "sliding friction";
    // derivative of the velocity of j relative to i where they touch, for constant ṙ and ω̄; the point moves
    // with the velocity p_i relative to the bodies
    const Vec3 gamma =
        omega_j.cross(omega_j.cross(s_j)) - omega_i.cross(omega_i.cross(s_i)) - omega.cross(rate.p_i);
    for (const int k : {0, 1}) {
        SpringRow& row = out[0].row[static_cast<std::size_t>(k)];
        const Vec3 t = k == 0 ? u : w;
        row.r_i = -t, row.pi_i = -(bi.A.transpose() * s_i.cross(t));
        row.r_j = t, row.pi_j = bj.A.transpose() * s_j.cross(t);
        row.gamma = gamma.dot(t);
    }

    set(out[1], law.roll, 2);
    for (const int k : {0, 1}) {
        const Vec3 t = law.lever(k, 0) * u + law.lever(k, 1) * w;  // ẏ/K = t · (ω × n) = ω · (n × t)
        rotation(out[1].row[static_cast<std::size_t>(k)], n.cross(t), ndot.cross(t));
    }

    set(out[2], law.spin, 1);
    rotation(out[2].row[0], n, ndot);
    return 3;
}

void TrackedForce::set_static_forces(lie::State& x, const StaticForce* forces) const
{
    if (is_active(x)) set_static_forces(at(x), x, forces);
}

void TrackedForce::set_static_forces(Instant now, lie::State& x, const StaticForce* forces) const
{
    const ContactState& m = now.contact_state;
    if (!(m.N > 0)) return;
    const StaticSprings law = pair().static_springs(m);
    Deflections& d = now.history.deflections;
    const auto deflection = [](const StaticSprings::Spring& of, const StaticForce& by) -> Vec2 {
        return of.K > 0 ? Vec2(by.f / of.K) : Vec2(Vec2::Zero());
    };
    const auto set = [](Regime& regime, const StaticForce& by) {
        regime = {.slipping = by.slips, .damped = !by.slips};
    };
    d.S = deflection(law.slide, forces[0]);
    d.Theta_i = law.lever.inverse() * deflection(law.roll, forces[1]);
    d.Psi = deflection(law.spin, forces[2])[0];
    set(d.slide, forces[0]), set(d.roll_i, forces[1]), set(d.spin, forces[2]);
    save(now, x);
}

void TrackedForce::check_derivatives(const lie::State& x, dae::DerivativeFindings& out) const
{
    check_surfaces(pair().i, pair().j, label(), out);
    const FrictionModel& friction = law();
    if (!is_active(x) || !out.is_next(typeid(friction))) return;
    try {
        check_friction_law(friction, loaded_state(x), label(), out);
    } catch (const lie::NumericalFailure&) {  // no contact point
    }
}

bool TrackedForce::is_touching(const lie::State& x) const
{
    ContactHistory m;
    restore_flags(flags(x), m);
    return m.touching;
}

double TrackedForce::internal_energy(const lie::State& x) const
{
    return is_active(x) && is_touching(x) ? internal_energy(at(x), x) : 0;
}

double TrackedForce::internal_energy(const Instant& now, const lie::State& x) const
{
    return pair().elastic_energy(now.contact_state, load(now, x), now.history);
}

bool TrackedForce::is_counted(const lie::State& x, Counted which) const
{
    try {
        return which == Counted::near ? is_near_contact(x) : is_touching(x);
    } catch (const lie::NumericalFailure& e) {
        rethrow(e, x);
    }
}

double TrackedForce::stable_step(const lie::State& x, lie::LoadEvaluation evaluation) const
{
    std::vector<int> near;
    model.count_contacts(x, Counted::near, near);
    return stable_step_with(x, evaluation, near);
}

ContactCounts TrackedForce::contacts(const lie::State& x, Counted which, std::span<const int> of_body) const
{
    int counted = is_counted(x, which) ? 1 : 0;
    // Other forces of the same contact, of which only one is active, count once
    if (normal_constraint() != nullptr)
        for (const int k : model.forces_on(i != dae::ground ? i : j)) {
            const auto* other = dynamic_cast<const TrackedForce*>(model.forces()[k].get());
            if (other != nullptr && other != this && other->normal_constraint() == normal_constraint())
                counted += other->is_counted(x, which);
        }
    const auto of = [&](int b) {
        return b == dae::ground ? 1. : of_body[static_cast<size_t>(b)] - counted + 1.;
    };
    return {of(i), of(j)};
}

void TrackedForce::rethrow(const lie::NumericalFailure& e, const lie::State& x) const
{
    std::ostringstream what;
    what << e.what() << "; bodies '" << name_i << "', '" << name_j << "', t = " << x.t << " s";
    throw lie::NumericalFailure(e.status, what.str());
}

}  // namespace hilda::contact
