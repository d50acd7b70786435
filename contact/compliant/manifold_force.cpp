// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/compliant/manifold_force.hpp"

#include "contact/compliant/missed_contact.hpp"
#include "contact/derivative_check.hpp"
#include "contact/detection/near_pairs.hpp"
#include "contact/internal_state.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/polytope.hpp"
#include "dae/model.hpp"

#include <algorithm>

namespace hilda::contact {

namespace {

constexpr double shares_within = 0.1;  // gap up to which points have a share, relative to the smaller size
constexpr double same_place = 0.05;    // distance of points with one history, relative to the smaller size
constexpr double any_gap = std::numeric_limits<double>::infinity();

/// A law that needs curvatures is for a smooth body beside one with edges: faces and edges have none.
void check_law(const std::string& label, const Shape& i, const Shape& j, const NormalLaw& normal,
               const FrictionModel& friction)
{
    const auto is_flat = [](const Shape& shape) {
        return dynamic_cast<const Polytope*>(shape.surface.get()) != nullptr ||
               dynamic_cast<const Plane*>(shape.surface.get()) != nullptr;
    };
    if (!is_flat(i) || !is_flat(j)) return;
    if (normal.needs_curvature())
        lie::reject(label, "the normal law needs the curvature of a surface; use hooke",
                    "a " + i.surface->name() + " and a " + j.surface->name());
    if (friction.needs_curvature())
        lie::reject(label, "rolling and spinning resistance need the curvature of a surface; leave them out",
                    "a " + i.surface->name() + " and a " + j.surface->name());
}

/// The points of a contact divide its part of the masses in the ratio of their shares.
ContactCounts of_share(const ContactCounts& contacts, double share)
{
    return {contacts.of_i / share, contacts.of_j / share};
}

}  // namespace

/// The place of the history of one contact point. Its internal states are those of a TrackedForce, its flags,
/// and the feature of the point.
class ManifoldForce::Point final : public TrackedForce {
public:
    Point(const ManifoldForce& owner, int number)
        : TrackedForce(owner.name, owner.model, owner.i, owner.j), number(number), owner(owner)
    {}

    const int number;

    static constexpr int flags_and_feature = 2;
    int states() const { return TrackedForce::internal_states() + flags_and_feature; }
    int first_of_history() const override { return owner.first_internal_state + number * states(); }
    double* more(lie::State& x) const
    {
        return x.internal_state.data() + first_of_history() + TrackedForce::internal_states();
    }
    const double* more(const lie::State& x) const
    {
        return x.internal_state.data() + first_of_history() + TrackedForce::internal_states();
    }
    std::uint32_t feature(const lie::State& x) const { return static_cast<std::uint32_t>(more(x)[1]); }
    int flags(const lie::State& x) const override { return static_cast<int>(more(x)[0]); }
    void set_flags(int flags, lie::State& x) const override { more(x)[0] = flags; }

    void save(const Instant& now, std::uint32_t feature, lie::State& x) const
    {
        TrackedForce::save(now, x);
        more(x)[1] = feature;
    }
    void clear(lie::State& x) const
    {
        std::fill_n(x.internal_state.begin() + first_of_history(), states(), 0.);
    }
    /// The place of the saved contact point, moved with body i
    Vec3 last_place(const lie::State& x) const
    {
        const Motion& bi = motion(x, i);
        return bi.r + bi.A * saved_history(x).contact_frame.c_i;
    }

    using TrackedForce::add;
    using TrackedForce::at;
    using TrackedForce::internal_energy;
    using TrackedForce::set_static_forces;
    using TrackedForce::static_springs;

private:
    const FrictionPair& pair() const override { return owner.contact; }
    bool applies_normal_force() const override { return true; }
    bool is_near_contact(const lie::State& x) const override { return is_touching(x); }
    ContactState evaluate(const lie::State& x, const ContactHistory&) const override
    {
        Touching touching;
        owner.evaluate(x, touching);
        for (const TouchingPoint& t : touching)
            if (t.point == this) return t.now;
        return {};
    }

    const ManifoldForce& owner;
};

ManifoldForce::ManifoldForce(const std::string& given_name, const dae::Model& model, int i,
                             const Shape& shape_i, int j, const Shape& shape_j,
                             std::shared_ptr<const NormalLaw> law,
                             std::shared_ptr<const FrictionModel> friction)
    : i(i), j(j), contact(given_name, shape_i, shape_j, TrackedForce::inertia(model, i),
                          TrackedForce::inertia(model, j), std::move(law), std::move(friction)),
      model(model), reach_i(reach_about_centre(shape_i)), reach_j(reach_about_centre(shape_j))
{
    name = given_name;
    check_law(label(), shape_i, shape_j, *contact.law, *contact.friction);
    for (int k = 0; k < Manifold::most; ++k) point.push_back(std::make_unique<Point>(*this, k));
}

ManifoldForce::~ManifoldForce() = default;

bool ManifoldForce::has_several_points(const Shape& i, const Shape& j)
{
    return dynamic_cast<const Polytope*>(i.surface.get()) != nullptr ||
           dynamic_cast<const Polytope*>(j.surface.get()) != nullptr;
}

/// f(), with the names of the bodies and the time in an error
template <class F>
auto ManifoldForce::named(const lie::State& x, const F& f) const
{
    try {
        return f();
    } catch (const lie::NumericalFailure& e) {
        point[0]->rethrow(e, x);
    }
}

/// The place for the history of a contact point, and whether it continues the history there
std::pair<const ManifoldForce::Point*, bool> ManifoldForce::point_for(const ManifoldPoint& p,
                                                                      const lie::State& x,
                                                                      const Manifold& manifold,
                                                                      unsigned taken) const
{
    const auto is_present = [&](std::uint32_t feature) {
        return std::any_of(manifold.begin(), manifold.end(),
                           [&](const ManifoldPoint& q) { return q.feature == feature && q.at.gap < 0; });
    };
    const Point *nearest = nullptr, *free = nullptr, *left = nullptr;
    double distance = same_place * contact.smaller_of_sizes();
    for (unsigned k = 0; k < point.size(); ++k) {
        if ((taken >> k & 1) != 0) continue;
        const Point& of = *point[k];
        if (!of.is_touching(x)) {
            if (free == nullptr) free = &of;
        } else if (of.feature(x) == p.feature) {
            return {&of, true};
        } else if (!is_present(of.feature(x))) {
            if (left == nullptr) left = &of;
            if (const double d = (of.last_place(x) - p.at.C()).norm(); d < distance)
                distance = d, nearest = &of;
        }
    }
    if (nearest != nullptr) return {nearest, true};
    return {free != nullptr ? free : left, false};
}

TrackedForce::Instant ManifoldForce::TouchingPoint::at(const lie::State& x) const
{
    return point->at(x, now, history);
}

void ManifoldForce::evaluate(const lie::State& x, Touching& out) const
{
    named(x, [&] {
        const Motion &bi = motion(x, i), &bj = motion(x, j);
        Manifold manifold;
        manifold.mean_places = true;
        contact.contact_points(bi, bj, shares_within * contact.smaller_of_sizes(), manifold);
        unsigned taken = 0;
        // points whose feature has a history first, so that no other point takes it
        for (const bool is_known : {true, false})
            for (const ManifoldPoint& p : manifold) {
                const auto has_history = [&](const auto& of) {
                    return of->is_touching(x) && of->feature(x) == p.feature;
                };
                if (!(p.at.gap < 0) || !(p.share > 0) ||
                    std::any_of(point.begin(), point.end(), has_history) != is_known)
                    continue;
                const auto [of, continues] = point_for(p, x, manifold, taken);
                if (of == nullptr) continue;
                taken |= 1U << of->number;
                const ContactHistory history = continues ? of->saved_history(x) : ContactHistory();
                const ContactState now = contact.evaluate_at(p.at, bi, bj, history, p.share);
                if (now.N > 0) out.all[static_cast<std::size_t>(out.count++)] = {of, p.feature, history, now};
            }
    });
}

void ManifoldForce::add(const lie::State& x, lie::Loads& out) const
{
    Touching touching;
    evaluate(x, touching);
    for (const TouchingPoint& t : touching) t.point->add(t.at(x), x, out);
}

double ManifoldForce::potential_energy(const lie::State& x) const
{
    Touching touching;
    evaluate(x, touching);
    double sum = 0;
    for (const TouchingPoint& t : touching) sum += contact.energy(t.now, motion(x, i), motion(x, j));
    return sum;
}

double ManifoldForce::internal_energy(const lie::State& x) const
{
    Touching touching;
    evaluate(x, touching);
    double sum = 0;
    for (const TouchingPoint& t : touching) sum += t.point->internal_energy(t.at(x), x);
    return sum;
}

std::string ManifoldForce::start_error(const lie::State& x) const
{
    return contact.start_error(motion(x, i), motion(x, j));
}

int ManifoldForce::internal_states() const { return Manifold::most * point[0]->states() + 1; }

void ManifoldForce::update_internal_state(lie::State& x) const
{
    Touching touching;
    evaluate(x, touching);
    unsigned saved = 0, checksum = 0;
    double overlap = 0;
    for (const TouchingPoint& t : touching) {
        t.point->save(t.at(x), t.feature, x);
        saved |= 1U << t.point->number;
        overlap = std::max(overlap, -t.now.contact_point.gap);
    }
    for (const auto& of : point) {
        if ((saved >> of->number & 1) == 0) of->clear(x);
        checksum = checksum * 31 + static_cast<unsigned>(of->flags(x));
    }
    x.discrete_state[first_discrete_state] = static_cast<int>(checksum >> 1);
    x.internal_state[first_internal_state + Manifold::most * point[0]->states()] = overlap;
}

double ManifoldForce::overlap(const lie::State& x) const
{
    return x.internal_state[first_internal_state + Manifold::most * point[0]->states()];
}

double ManifoldForce::relative_overlap(const lie::State& x) const
{
    return overlap(x) / contact.smaller_of_sizes();
}

void ManifoldForce::check_step(const lie::State& before, const lie::State& after) const
{
    if (overlap(before) > 0) return;
    const StepOfPair step = {motion(before, i), motion(after, i), motion(before, j),
                             motion(after, j),  before.t,         after.t};
    // the ground does not turn
    if (cannot_miss_contact(contact, step, i == dae::ground ? 0 : reach_i, j == dae::ground ? 0 : reach_j))
        return;
    check_for_missed_contact(contact, label(), step, nearest(before), {});
}

bool ManifoldForce::is_counted(const lie::State& x, Counted which) const
{
    if (which == Counted::touching)
        return std::any_of(point.begin(), point.end(), [&](const auto& p) { return p->is_touching(x); });
    Manifold manifold;
    named(x,
          [&] { contact.contact_points(motion(x, i), motion(x, j), contact.nearly_touching(), manifold); });
    return !manifold.empty();
}

ContactCounts ManifoldForce::counts(const lie::State& x, Counted which, std::span<const int> of_body) const
{
    const double others = is_counted(x, which) ? 0 : 1;
    const auto of = [&](int b) {
        return b == dae::ground ? 1. : of_body[static_cast<std::size_t>(b)] + others;
    };
    return {of(i), of(j)};
}

double ManifoldForce::stable_step(const lie::State& x, lie::LoadEvaluation evaluation) const
{
    std::vector<int> near;
    model.count_contacts(x, Counted::near, near);
    return stable_step_with(x, evaluation, near);
}

double ManifoldForce::stable_step_with(const lie::State& x, lie::LoadEvaluation evaluation,
                                       std::span<const int> near) const
{
    return named(x, [&] {
        const Motion &bi = motion(x, i), &bj = motion(x, j);
        Manifold manifold;
        contact.contact_points(bi, bj, any_gap, manifold);
        // the compression of a contact with the share 1; laws with a stiffness that grows are for balls
        const double gap = contact.state_at_largest_compression(bi, bj, {}, model.weight()).contact_point.gap;
        const ContactCounts contacts = counts(x, Counted::near, near);
        double least = std::numeric_limits<double>::infinity();
        for (ManifoldPoint p : manifold) {
            if (!(p.share > 0)) continue;
            p.at.gap = gap;
            const ContactState now =
                contact.state_without_history(p.at, {.r = bi.r, .A = bi.A}, {.r = bj.r, .A = bj.A}, p.share);
            least = std::min(least, contact.stable_step(now, bi, bj, of_share(contacts, p.share),
                                                        lie::damping_factor(evaluation)));
        }
        return least;
    });
}

bool ManifoldForce::is_stable(const lie::State& x, double h, lie::LoadEvaluation evaluation,
                              std::span<const int> touching) const
{
    if (!(overlap(x) > 0)) return true;
    Touching now;
    evaluate(x, now);
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    const ContactCounts contacts = counts(x, Counted::touching, touching);
    double sum = 0;  // of the shares, which is above 1 where edges cross beside corners
    for (const TouchingPoint& t : now) sum += t.now.share;
    return std::all_of(now.begin(), now.end(), [&](const TouchingPoint& t) {
        return contact.is_stable(h, lie::damping_factor(evaluation), t.now, bi, bj,
                                 of_share(contacts, t.now.share / std::max(1., sum)));
    });
}

int ManifoldForce::static_springs(const lie::State& x, StaticSpring* out) const
{
    Touching touching;
    evaluate(x, touching);
    for (const TouchingPoint& t : touching) out += t.point->static_springs(t.at(x), x, out);
    return springs_of_point * touching.count;
}

void ManifoldForce::set_static_forces(lie::State& x, const StaticForce* forces) const
{
    Touching touching;
    evaluate(x, touching);
    for (const TouchingPoint& t : touching) {
        t.point->set_static_forces(t.at(x), x, forces);
        forces += springs_of_point;
    }
}

void ManifoldForce::check_derivatives(const lie::State& x, dae::DerivativeFindings& out) const
{
    try {
        const Motion &bi = motion(x, i), &bj = motion(x, j);
        const ContactState now = contact.state_at_largest_compression(bi, bj, {}, model.weight());
        const FrictionModel& friction = *contact.friction;
        const NormalLaw& law = *contact.law;
        if (out.is_next(typeid(friction))) check_friction_law(friction, now, label(), out);
        if (out.is_next(typeid(law)))
            check_normal_law(law, contact.normal_input(now.contact_point, bi, bj), label(), out);
    } catch (const lie::NumericalFailure&) {  // no contact point
    }
}

ContactPoint ManifoldForce::nearest(const lie::State& x) const
{
    return named(x, [&] { return contact.contact_point(motion(x, i), motion(x, j), {}); });
}

void ManifoldForce::points(const lie::State& x, std::vector<LoadedPoint>& out) const
{
    out.clear();
    Touching touching;
    evaluate(x, touching);
    for (const TouchingPoint& t : touching) {
        const TrackedForce::Instant now = t.at(x);
        const Wrench friction = t.point->friction(now, x);
        out.push_back({.at = t.now.contact_point,
                       .feature = t.feature,
                       .N = t.now.share * t.now.N,
                       .F = friction.F,
                       .T = friction.T_i,
                       .slips = now.history.deflections.slide.slipping});
    }
    std::sort(out.begin(), out.end(),
              [](const LoadedPoint& a, const LoadedPoint& b) { return a.feature < b.feature; });
}

}  // namespace hilda::contact
