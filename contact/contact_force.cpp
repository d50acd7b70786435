// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/contact_force.hpp"

#include <cstring>

namespace hilda::contact {

namespace {

// Rounding of a pose that went through other coordinates and back, over 1 m and the distance from the origin; and
// of a time, over 1 s and itself
constexpr double at_rest = 1e-12;

/// All that a contact remembers in real numbers: the histories, the last way of the contact point over each body, which
/// gives the rolling of the dissertation its curvature, the track and the instant
struct Kept {
    Vec2 S = Vec2::Zero(), Theta_i = Vec2::Zero(), Theta_j = Vec2::Zero();
    Vec2 p_i = Vec2::Zero(), p_j = Vec2::Zero();
    Track track = {};
    double Psi = 0, t = 0;
};
constexpr size_t numbers = 5 * 2 + 6 * 3 + 2;
static_assert(sizeof(Kept) == numbers * sizeof(double), "what is kept is numbers and nothing else");

Kept kept(const lie::State& x, int first)
{
    Kept all;
    std::memcpy(static_cast<void*>(&all), x.remembered.data() + first, sizeof all);
    return all;
}

/// The one whole number: a bit for each flag that is not as in a memory without a past, so that zero is such a one
int flags_of(const Memory& m)
{
    int flags = m.found | m.touching << 1, bit = 2;
    for (const Regime* r : {&m.history.slide, &m.history.roll_i, &m.history.roll_j, &m.history.spin}) {
        flags |= r->slipping << bit++;
        flags |= !r->damped << bit++;
    }
    return flags;
}

void set_flags(int flags, Memory& m)
{
    int bit = 0;
    const auto next = [&] { return (flags >> bit++ & 1) != 0; };
    m.found = next(), m.touching = next();
    for (Regime* r : {&m.history.slide, &m.history.roll_i, &m.history.roll_j, &m.history.spin})
        r->slipping = next(), r->damped = !next();
}

Inertia inertia(const dae::Model& model, int b)
{
    if (b == dae::ground) return {};
    return {.m = model.mass().m[b], .J_bar = model.mass().J_bar[b]};
}

/// F [N, global] at C and T [N m, global] on body b
void put(int b, const Vec3& F, const Vec3& C, const Vec3& T, const lie::State& x, lie::Loads& out)
{
    if (b == dae::ground) return;
    const Motion& body = x.body[b];
    out.F[b] += F;
    out.n_bar[b] += body.A.transpose() * ((C - body.r).cross(F) + T);
}

}  // namespace

ContactForce::ContactForce(const std::string& name, const dae::Model& model, int i, const Shape& shape_i,
                           int j, const Shape& shape_j, std::shared_ptr<const NormalLaw> law,
                           std::shared_ptr<const FrictionModel> friction)
    : i(i), j(j), contact(name, shape_i, shape_j, inertia(model, i), inertia(model, j), std::move(law),
                          std::move(friction)),
      name_i(model.body_name(i)), name_j(model.body_name(j)), model(model)
{
    this->name = name;
    if (i == j) lie::reject(in_words(), "a contact needs two different bodies", "'" + name_i + "' twice");
}

int ContactForce::remembered() const { return numbers; }

Memory ContactForce::recall(const lie::State& x) const
{
    Memory m;
    set_flags(x.memory[first_memory], m);
    const Kept all = kept(x, first_remembered);
    m.track = all.track;
    m.history.S = all.S, m.history.Theta_i = all.Theta_i, m.history.Theta_j = all.Theta_j;
    m.history.Psi = all.Psi;
    return m;
}

void ContactForce::keep(const Instant& now, lie::State& x) const
{
    const Memory& m = now.memory;
    x.memory[first_memory] = flags_of(m);
    const Slip& s = now.meeting.slip;
    Kept all;
    all.S = m.history.S, all.Theta_i = m.history.Theta_i, all.Theta_j = m.history.Theta_j;
    all.Psi = m.history.Psi;
    all.track = m.track;
    all.t = x.t;
    if (m.touching) all.p_i = components(s.p_i, s.n, s.u), all.p_j = components(s.p_j, s.n, s.u);
    std::memcpy(x.remembered.data() + first_remembered, &all, sizeof all);
}

ContactForce::Instant ContactForce::at(const lie::State& x) const
{
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    Instant now{.meeting = {}, .memory = recall(x)};
    try {
        now.meeting = contact.meet(bi, bj, now.memory);
    } catch (const lie::NumericalFailure& e) {
        rethrow(e, x);
    }
    Slip& s = now.meeting.slip;
    if (now.meeting.N > 0 && now.memory.touching) {
        const Kept last = kept(x, first_remembered);
        const double length = at_rest * (1 + now.meeting.touch.C().norm());
        if (std::abs(x.t - last.t) <= at_rest * (1 + std::abs(x.t)) && s.p_i.norm() < length &&
            s.p_j.norm() < length && std::abs(s.psi) < at_rest) {
            const Vec3 n = s.n, u = s.u;
            s = no_slip(now.meeting.touch, u);
            s.p_i = tangent(last.p_i, n, u), s.p_j = tangent(last.p_j, n, u);
            return now;
        }
    }
    contact.advance(now.meeting, bi, bj, now.memory);
    return now;
}

void ContactForce::add(const lie::State& x, lie::Loads& out) const
{
    if (!works(x)) return;
    const Instant now = at(x);
    const Meeting& m = now.meeting;
    if (!(m.N > 0)) return;
    const Wrench w = contact.load(m, rates(m.touch, m.slip, motion(x, i), motion(x, j)), now.memory);
    const Vec3 F = m.N * m.touch.n + w.F, C = m.touch.C();
    put(i, F, C, w.T_i, x, out);
    put(j, -F, C, w.T_j, x, out);
}

Wrench ContactForce::friction(const lie::State& x) const
{
    if (!works(x)) return {};
    const Instant now = at(x);
    const Meeting& m = now.meeting;
    if (!(m.N > 0)) return {};
    return contact.load(m, rates(m.touch, m.slip, motion(x, i), motion(x, j)), now.memory);
}

void ContactForce::remember(lie::State& x) const
{
    if (works(x)) keep(at(x), x);
}

double ContactForce::potential_energy(const lie::State& x) const
{
    if (!works(x)) return 0;
    return contact.energy(at(x).meeting, motion(x, i), motion(x, j));
}

std::string ContactForce::objection(const lie::State& x) const
{
    if (replaced != nullptr) return {};  // whether the surfaces fit it is asked when it works
    return contact.objection(motion(x, i), motion(x, j));
}

double ContactForce::stable_step(const lie::State& x) const
{
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    double weight = 0;  // all that may rest on the contact
    for (const double m : model.mass().m) weight += m * model.gravity.norm();
    try {
        return contact.stable_step(contact.hardest(bi, bj, recall(x), weight), bi, bj, contacts_of(i, x),
                                   contacts_of(j, x));
    } catch (const lie::NumericalFailure& e) {
        rethrow(e, x);
    }
}

int ContactForce::contacts_of(int body, const lie::State& x) const
{
    int count = 0;
    for (const auto& force : model.forces()) {
        const auto* other = dynamic_cast<const ContactForce*>(force.get());
        if (other == nullptr || (other->i != body && other->j != body)) continue;
        if (other == this || other->contact.close(motion(x, other->i), motion(x, other->j), other->recall(x)))
            ++count;
    }
    return std::max(1, count);
}

void ContactForce::rethrow(const lie::NumericalFailure& e, const lie::State& x) const
{
    std::ostringstream what;
    what << e.what() << "; bodies '" << name_i << "', '" << name_j << "', t = " << x.t << " s";
    throw lie::NumericalFailure(e.status, what.str());
}

}  // namespace hilda::contact
