// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/evolving/unilateral.hpp"

#include "dae/start.hpp"
#include "lie/check.hpp"

#include <algorithm>

namespace hilda::contact {

namespace {

using lie::State;

constexpr double touching = 1e-13;  // a gap, over the size of the contact, that is none
constexpr int most_searches = 80;   // steps of regula falsi
constexpr int most_events = 50;     // for each contact in one step
constexpr double rest = 1e-9;       // of a step, that is not worth a step

}  // namespace

UnilateralStep::UnilateralStep(const dae::Model& model, const lie::Scheme& scheme,
                               const lie::Settings& settings)
    : model(model), scheme(scheme.make(model, settings)), K(model, lie::Metric::mass, settings.linear_solver),
      momentum(Eigen::VectorXd::Zero(6 * model.bodies())), v(K.size())
{
    for (size_t n = 0; n < model.evolving().size(); ++n) {
        const auto* c = dynamic_cast<const EvolvingContact*>(model.evolving()[n].get());
        if (c != nullptr && c->may_be_inactive()) contact.push_back({c, static_cast<int>(n)});
    }
}

void UnilateralStep::TrackedContact::note(double t, double F_N)
{
    if (t == last.t) return;
    before = last;
    last = {t, F_N};
}

/// When F_N was zero on its way to this value at t
double UnilateralStep::TrackedContact::lift_off(double t, double F_N) const
{
    if (!(last.t < t) || !(last.F_N > 0)) return t;
    const double slope = (F_N - last.F_N) / (t - last.t);
    double s = -last.F_N / slope;  // after last.t, on the straight line
    if (before.t < last.t) {
        const double bend = (slope - (last.F_N - before.F_N) / (last.t - before.t)) / (t - before.t);
        for (int k = 0; k < 5; ++k)
            s -= (last.F_N + slope * s + bend * s * (s + last.t - t)) / (slope + bend * (2 * s + last.t - t));
    }
    return std::clamp(last.t + s, last.t, t);
}

/// F_N in the pose of x by these multipliers
double UnilateralStep::force(const TrackedContact& c, const State& x, const Eigen::VectorXd& lambda) const
{
    return c.contact->multipliers(model.at(*c.contact, x), lambda).F_N;
}

double UnilateralStep::gap(const TrackedContact& c, const State& x) const
{
    return c.contact->gap(model.at(*c.contact, x));
}

double UnilateralStep::separation_speed(const TrackedContact& c, const State& x) const
{
    return c.contact->separation_speed(model.at(*c.contact, x));
}

bool UnilateralStep::overlaps(const TrackedContact& c, const State& x) const
{
    return open(c, x) && gap(c, x) < -touching * c.contact->L;
}

/// The nearest points of the open contacts
void UnilateralStep::update_alpha(State& x) const
{
    for (const TrackedContact& c : contact)
        if (open(c, x))
            c.contact->update_alpha(model.at(*c.contact, x), false, x.alpha.data() + c.contact->first_alpha);
}

int UnilateralStep::step(State& x, double h)
{
    tell_of_handed_over(x);
    struct Restore {
        State &x, &from;
        std::vector<ContactEvent>& happened;
        const size_t events;
        bool done = false;
        ~Restore()
        {
            if (done) return;
            x = from;
            happened.resize(events);
        }
    } restore{x, first = x, happened, happened.size()};
    begin = x;
    size_t kept = happened.size();
    for (;;) try {
            const int iterations = advance(x, h);
            restore.done = true;
            return iterations;
        } catch (const lie::NumericalFailure&) {
            x = begin;
            happened.resize(kept);
            if (!hand_over_flattest(x)) throw;
            kept = happened.size();
            restart(x);
            begin = x;
        }
}

void UnilateralStep::fill_node(State& node, const State&) const
{
    for (size_t b = 0; b < node.body.size(); ++b) {
        const lie::Motion& from = known.body[b];
        lie::Motion& to = node.body[b];
        to.rdot = from.rdot, to.omega_bar = from.omega_bar;
        to.rddot = from.rddot, to.omegadot_bar = from.omegadot_bar;
    }
    node.lambda = known.lambda;
}

UnilateralStep::Past UnilateralStep::past() const
{
    Past all{.events = happened, .closed = {}};
    for (const TrackedContact& c : contact) {
        all.closed.push_back(c.before);
        all.closed.push_back(c.last);
    }
    return all;
}

void UnilateralStep::go_on_from(const Past& past)
{
    if (past.closed.size() != 2 * contact.size())
        lie::reject("contact::UnilateralStep",
                    "a past must be that of a model with as many contacts that open", past.closed.size() / 2);
    happened = past.events;
    for (size_t k = 0; k < contact.size(); ++k) {
        contact[k].before = past.closed[2 * k];
        contact[k].last = past.closed[2 * k + 1];
    }
}

/// From t_n to t_n + h, with all that happens on the way
int UnilateralStep::advance(State& x, double h)
{
    int iterations = 0;
    const int most = most_events * static_cast<int>(contact.size() + 1);
    for (TrackedContact& c : contact) c.held = false, c.closings = 0;
    double left = h;
    for (int part = 0; part < most; ++part) {
        node = x;
        // a scheme that lags and has a history finds the forces of this node with the step
        const bool anew_here = part > 0 || (scheme->keeps_history() && node.history.size() == 0);
        const bool forces_known = !scheme->is_staggered() || anew_here;
        if (forces_known && release_pulling(node)) restart(node);
        int k = try_step(node, trial, left);
        while (!forces_known) {
            node.lambda = trial.lambda;
            if (!release_pulling(node)) break;
            k += try_step(node, trial, left);
        }
        iterations = std::max(iterations, k);

        anew = node;
        if (!forces_known) scheme->fill_node(anew, trial);
        anew.history.resize(0);
        if (part == 0) known = anew;
        for (TrackedContact& c : contact)
            if (closed(c, node)) c.note(node.t, force(c, node, anew.lambda));

        TrackedContact* closing = nullptr;
        const double taken = find_closing(trial, left, closing);
        if (closing == nullptr) {
            x = trial;
            if (part > 0) restart(x);  // its history is of another step
            return iterations;
        }
        if (taken > 0) model.accepted(node, trial);
        collide(trial, *closing, h);
        x = trial;
        left -= taken;
        if (left <= rest * h) {
            x.t = begin.t + h;
            return iterations;
        }
    }
    std::string last;
    for (const TrackedContact& c : contact)
        if (c.closings >= most_meetings) last += (last.empty() ? "'" : ", '") + c.contact->name + "'";
    throw lie::NumericalFailure("too_many_impacts",
                                "contacts open and close without end within one step, more than " +
                                    std::to_string(most) + " times: " + last);
}

/// One step of the scheme, and the points of what is open after it
int UnilateralStep::try_step(const State& from, State& to, double h)
{
    to = from;
    const int k = scheme->step(to, h);
    to.t = from.t + h;
    update_alpha(to);
    return k;
}

/// Hands over the closed contact whose surfaces fit each other best, if there is one that may be. Where a step fails,
/// that is the one to blame.
bool UnilateralStep::hand_over_flattest(State& x)
{
    TrackedContact* flattest = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (TrackedContact& c : contact)
        if (closed(c, x) && c.contact->has_fallback())
            if (const double k =
                    least_curvature(c.contact->contact_point(model.at(*c.contact, x))) * c.contact->L;
                k < least)
                flattest = &c, least = k;
    if (flattest == nullptr) return false;
    hand_over(*flattest, x, 0);
    return true;
}

/// A contact may have handed over in the start, or when the step to x was accepted.
void UnilateralStep::tell_of_handed_over(const State& x)
{
    for (TrackedContact& c : contact) {
        if (c.gone || mode(c, x) != dae::Constraint::fallback_active) continue;
        c.gone = true;
        const auto told = [&](const ContactEvent& e) {
            return e.contact == c.number && e.type == ContactEvent::Type::fallback_active;
        };
        if (std::none_of(happened.begin(), happened.end(), told))
            happened.push_back(
                {.type = ContactEvent::Type::fallback_active, .t = x.t, .contact = c.number, .speed = 0});
    }
}

void UnilateralStep::hand_over(const TrackedContact& c, State& x, double speed)
{
    dae::Model::set_mode(*c.contact, x, dae::Constraint::fallback_active);
    happened.push_back(
        {.type = ContactEvent::Type::fallback_active, .t = x.t, .contact = c.number, .speed = speed});
}

/// Accelerations and multipliers of a node, from which a scheme is to start anew
void UnilateralStep::restart(State& x)
{
    x.history.resize(0);
    do dae::solve_accelerations(model, K, x);
    while (release_pulling(x));
}

/// Opens the closed contact that pulls most, by the multipliers in x, if there is one.
bool UnilateralStep::release_pulling(State& x)
{
    TrackedContact* worst = nullptr;
    double least = 0, largest = 0;
    for (TrackedContact& c : contact) {
        if (!closed(c, x)) continue;
        const double F_N = force(c, x, x.lambda);
        largest = std::max(largest, std::abs(F_N));
        if (c.contact->unilateral.enabled && !c.held && F_N < least) worst = &c, least = F_N;
    }
    if (worst == nullptr || !(least < -rounding * largest)) return false;
    happened.push_back(
        {.type = ContactEvent::Type::lift_off, .t = worst->lift_off(x.t, least), .contact = worst->number});
    dae::Model::set_mode(*worst->contact, x, dae::Constraint::inactive);
    return true;
}

/// Of the contacts that overlap in `to` and did not in `from`, the one whose gap a straight line has zero first
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

/// How long a step from `anew` takes to where the first gap is zero; `to` is then there. h, and no contact, where none
/// overlaps in `to`.
double UnilateralStep::find_closing(State& to, double h, TrackedContact*& first)
{
    first = nullptr;
    const double whole = h;
    while (TrackedContact* next = first_to_close(anew, to)) {
        first = next;
        h = zero_of_gap(*next, to, h);
        if (!(h > 0)) {
            // it opened here and does not leave, or there is no impact to speak of
            if (!(whole * separation_speed(*next, anew) < -rounding * next->contact->L)) next->held = true;
            to = anew;
            return 0;
        }
    }
    return h;
}

/// The length of step, up to h, after which the gap of c is zero, where it is negative after h; 0 where it is none to
/// begin with and does not open.
double UnilateralStep::zero_of_gap(const TrackedContact& c, State& to, double h)
{
    const double none = touching * c.contact->L;
    double a = 0, g_a = gap(c, anew), b = h, g_b = gap(c, to);
    for (int halving = 0; g_a <= none; ++halving) {  // it leaves and comes back
        if (halving == 6 || !(separation_speed(c, anew) > 0)) return 0;
        a = halving == 0 ? 0.5 * h : 0.5 * a;
        try_step(anew, to, a);
        g_a = gap(c, to);
        if (g_a < -none) b = a, g_b = g_a;
    }
    double s = b;
    for (int k = 0, last = 0; k < most_searches; ++k) {
        s = (a * g_b - b * g_a) / (g_b - g_a);
        if (!(s > a && s < b)) s = 0.5 * (a + b);
        try_step(anew, to, s);
        const double g = gap(c, to);
        if (std::abs(g) <= none) return s;
        // regula falsi; the end that stays twice counts half ("Illinois")
        if (g < 0) {
            b = s, g_b = g;
            if (last < 0) g_a /= 2;
            last = -1;
        } else {
            a = s, g_a = g;
            if (last > 0) g_b /= 2;
            last = 1;
        }
        if (!(b - a > 1e-15 * h)) break;
    }
    // rounding is coarser than that: the last that does not overlap
    try_step(anew, to, a);
    return a;
}

std::unique_ptr<lie::Integrator> make_integrator(const dae::Model& model, const lie::Scheme& scheme,
                                                 const lie::Settings& settings)
{
    for (const auto& c : model.evolving())
        if (c->may_be_inactive()) return std::make_unique<UnilateralStep>(model, scheme, settings);
    return scheme.make(model, settings);
}

}  // namespace hilda::contact
