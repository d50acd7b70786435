// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/evolving/unilateral.hpp"

#include "contact/compliant/compliant_force.hpp"
#include "dae/model.hpp"
#include "lie/bracket.hpp"
#include "lie/check.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/steps/accelerations.hpp"

#include <algorithm>
#include <utility>

namespace hilda::contact {

namespace {

using lie::State;

constexpr double short_motion = 0.1;     // of bodies in a step, relative to L: contact cannot be missed
constexpr double gap_tolerance = 1e-13;  // gap counted as zero, relative to L
constexpr double narrowest = 1e-15;      // width of a bracket of a zero gap, relative to the step
constexpr int max_events = 50;           // in one step, for each contact
constexpr double min_remainder = 1e-9;   // remaining time that is skipped, relative to h

}  // namespace

UnilateralStep::UnilateralStep(const dae::Model& model, const lie::Scheme& scheme,
                               const lie::Settings& settings)
    : model(model), scheme(scheme.make(model, settings)), K(model, lie::Metric::mass, settings.linear_solver),
      momentum(Eigen::VectorXd::Zero(6 * model.bodies())), v(K.size())
{
    for (size_t n = 0; n < model.general_constraints().size(); ++n) {
        const auto* c = dynamic_cast<const EvolvingContact*>(model.general_constraints()[n].get());
        if (c != nullptr && c->may_be_inactive()) contact.push_back({c, static_cast<int>(n)});
    }
}

void UnilateralStep::TrackedContact::record(double t, double F_N)
{
    if (t == last_node.t) return;
    previous_node = last_node;
    last_node = {t, F_N};
}

/// Time [s] at which the parabola through F_N of the last two nodes and of the present one is zero. The
/// present F_N at t is negative. Newton's method starts from the zero of the secant through the last node
/// and the present one.
double UnilateralStep::TrackedContact::lift_off_time(double t, double F_N) const
{
    if (!(last_node.t < t) || !(last_node.F_N > 0)) return t;
    const double slope = (F_N - last_node.F_N) / (t - last_node.t);
    double s = -last_node.F_N / slope;  // zero of the secant, relative to last_node.t
    if (previous_node.t < last_node.t) {
        const double curvature =
            (slope - (last_node.F_N - previous_node.F_N) / (last_node.t - previous_node.t)) /
            (t - previous_node.t);
        for (int k = 0; k < 5; ++k)
            s -= (last_node.F_N + slope * s + curvature * s * (s + last_node.t - t)) /
                 (slope + curvature * (2 * s + last_node.t - t));
    }
    return std::clamp(last_node.t + s, last_node.t, t);
}

/// Normal component of the multipliers λ_Ψ of c in the pose of x: F_N [N], or a normal impulse [N s]
double UnilateralStep::force(const TrackedContact& c, const State& x, const Eigen::VectorXd& lambda) const
{
    return c.contact->multipliers(model.arguments(*c.contact, x), lambda).F_N;
}

double UnilateralStep::gap(const TrackedContact& c, const State& x) const
{
    return c.contact->gap(model.arguments(*c.contact, x));
}

double UnilateralStep::separation_speed(const TrackedContact& c, const State& x) const
{
    return c.contact->separation_speed(model.arguments(*c.contact, x));
}

bool UnilateralStep::overlaps(const TrackedContact& c, const State& x) const
{
    return is_inactive(c, x) && gap(c, x) < -gap_tolerance * c.contact->L;
}

/// The relative motion of the surfaces of a contact in a step
Passage UnilateralStep::passage(const TrackedContact& c, const State& from, const State& to) const
{
    const EvolvingContact& at = *c.contact;
    const double* const alpha = model.arguments(at, from).alpha;
    return Passage(dae::motion(from, at.i), dae::motion(to, at.i), dae::motion(from, at.j),
                   dae::motion(to, at.j), to.t - from.t, Vec3::Map(alpha).norm(),
                   Vec3::Map(alpha + 3).norm());
}

/// Updates the nearest points of the inactive contacts after a step. After a long motion Newton's method
/// may find other points with a common normal, such as those at the far sides of two spheres.
void UnilateralStep::update_alpha(const State& from, State& to) const
{
    for (const TrackedContact& c : contact)
        if (is_inactive(c, to))
            c.contact->update_alpha(model.arguments(*c.contact, to),
                                    passage(c, from, to).length() > short_motion * c.contact->L,
                                    to.alpha.data() + dae::Model::place(*c.contact).alpha);
}

int UnilateralStep::step(State& x, double h)
{
    report_fallbacks(x);
    step_start = x;
    struct Rollback {
        State& x;
        const State* from;
        std::vector<ContactEvent>& event_log;
        const size_t events;
        bool done = false;
        ~Rollback()
        {
            if (done) return;
            x = *from;
            event_log.resize(events);
        }
    } rollback{x, &step_start, event_log, event_log.size()};
    size_t kept_events = event_log.size();
    for (;;) try {
            const int iterations = advance(x, h);
            rollback.done = true;
            return iterations;
        } catch (const lie::NumericalFailure& failure) {
            const std::string active_contacts = names_of_active(x);
            if (rollback.from == &step_start) rollback.from = &(at_entry = step_start);
            x = step_start;
            event_log.resize(kept_events);
            if (!switch_least_curved_to_fallback(x)) {
                const auto* singular = dynamic_cast<const lie::SingularMatrix*>(&failure);
                if (singular == nullptr || active_contacts.empty()) throw;
                throw lie::SingularMatrix(failure.what() + active_contacts, singular->reciprocal_condition);
            }
            kept_events = event_log.size();
            restart(x);
            step_start = x;
        }
}

/// "; active contacts: 'a', 'b'" for a message, at most 5 names; empty if there is none
std::string UnilateralStep::names_of_active(const State& x) const
{
    constexpr int most = 5;
    std::string names;
    int number = 0;
    for (const TrackedContact& c : contact)
        if (is_active(c, x) && ++number <= most) names += (number == 1 ? "'" : ", '") + c.contact->name + "'";
    if (number > most) names += " and " + std::to_string(number - most) + " more";
    return number > 0 ? "; active contacts: " + names : names;
}

void UnilateralStep::fill_node(State& node, const State&) const
{
    for (size_t b = 0; b < node.body.size(); ++b) {
        const lie::Motion& from = full_node.body[b];
        lie::Motion& to = node.body[b];
        to.rdot = from.rdot, to.omega_bar = from.omega_bar;
        to.rddot = from.rddot, to.omegadot_bar = from.omegadot_bar;
    }
    node.lambda = full_node.lambda;
}

UnilateralStep::History UnilateralStep::history() const
{
    History all{.events = event_log, .node_forces = {}};
    for (const TrackedContact& c : contact) {
        all.node_forces.push_back(c.previous_node);
        all.node_forces.push_back(c.last_node);
    }
    return all;
}

void UnilateralStep::restore(const History& saved)
{
    if (saved.node_forces.size() != 2 * contact.size())
        lie::reject("contact::UnilateralStep",
                    "the history must be of a model with as many unilateral contacts",
                    saved.node_forces.size() / 2);
    event_log = saved.events;
    for (size_t k = 0; k < contact.size(); ++k) {
        contact[k].previous_node = saved.node_forces[2 * k];
        contact[k].last_node = saved.node_forces[2 * k + 1];
    }
}

/// Advances x from t_n to t_n + h through all events. During a part of the step x is its beginning and
/// `trial` its end.
int UnilateralStep::advance(State& x, double h)
{
    int iterations = 0;
    const int max_parts = max_events * static_cast<int>(contact.size() + 1);
    for (TrackedContact& c : contact) c.stays_active = false, c.impacts = 0;
    double remaining = h;
    for (int part = 0; part < max_parts; ++part) {
        // A staggered scheme computes the multipliers of this node in the step that starts there. After a
        // restart they are known already.
        const bool restarts = part > 0 || (scheme->keeps_history() && x.history.size() == 0);
        const bool forces_known = !scheme->is_staggered() || restarts;
        if (forces_known && deactivate_tensile(x)) restart(x);
        int k = try_step(x, trial, remaining);
        while (!forces_known) {
            x.lambda = trial.lambda;
            if (!deactivate_tensile(x)) break;
            k += try_step(x, trial, remaining);
        }
        iterations = std::max(iterations, k);

        State& from = part == 0 ? full_node : restart_node;
        from = x;
        if (!forces_known) scheme->fill_node(from, trial);
        from.history.resize(0);
        for (TrackedContact& c : contact)
            if (is_active(c, x)) c.record(x.t, force(c, x, from.lambda));

        TrackedContact* closing = nullptr;
        const double elapsed = find_closing(from, trial, remaining, closing);
        if (closing == nullptr) {
            std::swap(x, trial);
            if (part > 0) restart(x);  // the history of x is that of another step size
            return iterations;
        }
        if (elapsed > 0) model.accepted(x, trial);
        std::swap(x, trial);
        resolve_impact(x, *closing, h);
        remaining -= elapsed;
        if (remaining <= min_remainder * h) {
            x.t = step_start.t + h;
            return iterations;
        }
    }
    std::string last;
    for (const TrackedContact& c : contact)
        if (c.impacts >= max_impacts) last += (last.empty() ? "'" : ", '") + c.contact->name + "'";
    throw lie::NumericalFailure("too_many_impacts",
                                "more than " + std::to_string(max_parts) +
                                    " contact events in one step; contacts that close repeatedly: " + last +
                                    "; use a smaller step, restitution 0, or compliant contacts");
}

/// One step of the scheme, then the nearest points of the inactive contacts
int UnilateralStep::try_step(const State& from, State& to, double h)
{
    to = from;
    const int k = scheme->step(to, h);
    to.t = from.t + h;
    update_alpha(from, to);
    return k;
}

/// Switches the active contact with the smallest relative curvature (smaller eigenvalue of K_i + K_j,
/// times L) to its fallback. This contact is the most likely reason of a failed step. Returns false if no
/// active contact has a fallback.
bool UnilateralStep::switch_least_curved_to_fallback(State& x)
{
    TrackedContact* least_curved = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (TrackedContact& c : contact)
        if (is_active(c, x) && c.contact->fallback)
            if (const double k =
                    least_curvature(c.contact->contact_point(model.arguments(*c.contact, x))) * c.contact->L;
                k < least)
                least_curved = &c, least = k;
    if (least_curved == nullptr) return false;
    switch_to_fallback(*least_curved, x, 0);
    return true;
}

/// Logs the switches to a fallback that happened at the start or when the step to x was accepted.
void UnilateralStep::report_fallbacks(const State& x)
{
    for (TrackedContact& c : contact) {
        if (c.fallback_reported || mode(c, x) != EvolvingContact::fallback_active) continue;
        c.fallback_reported = true;
        const auto logged = [&](const ContactEvent& e) {
            return e.contact == c.number && e.type == ContactEvent::Type::fallback_active;
        };
        if (std::none_of(event_log.begin(), event_log.end(), logged))
            event_log.push_back(
                {.type = ContactEvent::Type::fallback_active, .t = x.t, .contact = c.number, .speed = 0});
    }
}

void UnilateralStep::switch_to_fallback(const TrackedContact& c, State& x, double speed)
{
    dae::Model::set_mode(*c.contact, x, EvolvingContact::fallback_active);
    event_log.push_back(
        {.type = ContactEvent::Type::fallback_active, .t = x.t, .contact = c.number, .speed = speed});
}

/// Computes accelerations and multipliers of a node from which the scheme restarts; deactivates tensile
/// contacts.
void UnilateralStep::restart(State& x)
{
    x.history.resize(0);
    do lie::solve_accelerations(model, K, x);
    while (deactivate_tensile(x));
}

/// Deactivates the active unilateral contact with the most negative F_N, computed from the multipliers in x.
/// Returns false if no F_N is negative beyond rounding.
bool UnilateralStep::deactivate_tensile(State& x)
{
    TrackedContact* worst = nullptr;
    double least = 0, largest = 0;
    for (TrackedContact& c : contact) {
        if (!is_active(c, x)) continue;
        const double F_N = force(c, x, x.lambda);
        largest = std::max(largest, std::abs(F_N));
        if (c.contact->unilateral.enabled && !c.stays_active && F_N < least) worst = &c, least = F_N;
    }
    if (worst == nullptr || !(least < -rounding * largest)) return false;
    event_log.push_back({.type = ContactEvent::Type::lift_off,
                         .t = worst->lift_off_time(x.t, least),
                         .contact = worst->number});
    dae::Model::set_mode(*worst->contact, x, EvolvingContact::inactive);
    return true;
}

/// Returns the inactive contact that closes first between `from` and `to`, by linear interpolation of the
/// gaps. Returns nullptr if no inactive contact overlaps in `to`.
UnilateralStep::TrackedContact* UnilateralStep::first_to_close(const State& from, const State& to)
{
    TrackedContact* next = nullptr;
    double earliest = 2;
    for (TrackedContact& c : contact) {
        if (!overlaps(c, to)) continue;
        const double g = std::max(gap(c, from), 0.), part = g / (g - gap(c, to));
        if (part < earliest) earliest = part, next = &c;
    }
    return next;
}

/// The part of the step after which the bodies of an inactive contact without an overlap in `to` have passed
/// into each other; 1 if there is none
double UnilateralStep::first_passage(const State& from, const State& to) const
{
    double first = 1;
    for (const TrackedContact& c : contact) {
        if (!is_inactive(c, from) || overlaps(c, to)) continue;
        const EvolvingContact& at = *c.contact;
        const Passage motion = passage(c, from, to);
        const double begin = gap(c, from);
        if (!(motion.length() > short_motion * at.L) || !(begin > gap_tolerance * at.L) ||
            begin + gap(c, to) > motion.length())
            continue;
        const double s = motion.first_overlap(
            begin, at.L, [&](const Motion& bi, const Motion& bj) { return at.distance(bi, bj); });
        first = std::min(first, s);
    }
    return first;
}

/// Returns the length of the step from `from` after which the first gap is zero, and sets `to` to the
/// state there and `first` to the contact. Returns h and sets `first` to nullptr if no inactive contact
/// overlaps in `to`.
double UnilateralStep::find_closing(const State& from, State& to, double h, TrackedContact*& first)
{
    first = nullptr;
    for (double s = 1; (s = first_passage(from, to)) < 1;) {
        h *= s;
        try_step(from, to, h);
    }
    const double whole = h;
    while (TrackedContact* next = first_to_close(from, to)) {
        first = next;
        h = find_zero_gap(*next, from, to, h);
        if (!(h > 0)) {
            // The gap is already zero at the node. If the approach speed is within rounding, there is no
            // impact. For example, the contact has become inactive at this node but does not separate. It
            // then becomes active again and stays active for this step.
            if (!(whole * separation_speed(*next, from) < -rounding * next->contact->L))
                next->stays_active = true;
            to = from;
            return 0;
        }
    }
    return h;
}

/// Step length in (0, h] after which the gap of c is zero, given a negative gap after h. Returns 0 if the
/// gap is zero at the node and no positive gap is found after h/2, h/4, …, h/64.
double UnilateralStep::find_zero_gap(const TrackedContact& c, const State& from, State& to, double h)
{
    const double tolerance = gap_tolerance * c.contact->L;
    double a = 0, g_a = gap(c, from), b = h, g_b = gap(c, to);
    for (int halving = 0; g_a <= tolerance; ++halving) {  // the gap may open first and close again
        if (halving == 6 || !(separation_speed(c, from) > 0)) return 0;
        a = halving == 0 ? 0.5 * h : 0.5 * a;
        try_step(from, to, a);
        g_a = gap(c, to);
        if (g_a < -tolerance) b = a, g_b = g_a;
    }
    lie::Bracket bracket(a, g_a, b, g_b);
    double found = 0;
    lie::narrow(bracket, narrowest * h, [&](double s) {
        try_step(from, to, s);
        const double g = gap(c, to);
        if (std::abs(g) > tolerance) return g;
        found = s;
        return 0.;
    });
    if (found > 0) return found;
    // Rounding prevents a gap within the tolerance. Take the longest step known to have no overlap.
    try_step(from, to, bracket.a);
    return bracket.a;
}

std::unique_ptr<lie::Integrator> make_integrator(const dae::Model& model, const lie::Scheme& scheme,
                                                 const lie::Settings& settings)
{
    // The state of a contact changes at the ends of steps, with an error that the estimate of a step does not
    // contain. A long step may also pass over a contact that closes. The adaptive schemes on Euler parameters
    // (IDA) have events.
    const auto refuse_adaptive = [&](const std::string& contact) {
        if (scheme.adaptive && scheme.formulation == "rA")
            lie::reject("integrator " + scheme.name,
                        "adaptive steps do not support contacts; use a fixed step", contact);
    };
    for (const auto& f : model.forces())
        if (dynamic_cast<const CompliantForce*>(f.get()) != nullptr) refuse_adaptive(f->label());
    for (const auto& group : model.near_forces().all_groups()) refuse_adaptive(group->example().label());
    for (const auto& c : model.general_constraints())
        if (c->algebraic_variables() > 0) refuse_adaptive("contact '" + c->name + "'");
    for (const auto& c : model.general_constraints())
        if (c->may_be_inactive()) return std::make_unique<UnilateralStep>(model, scheme, settings);
    return scheme.make(model, settings);
}

}  // namespace hilda::contact
