// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/columns/contact_outputs.hpp"

#include "contact/compliant/contact_force.hpp"
#include "contact/compliant/contact_group.hpp"
#include "contact/compliant/manifold_force.hpp"
#include "contact/internal_state.hpp"
#include "dae/model.hpp"
#include "run/columns/state_columns.hpp"

#include <algorithm>
#include <limits>

namespace hilda::run {

namespace {

using lie::Vec3;

/// Tangential speed of body j relative to body i at the contact point [m/s]
double slip_speed(const contact::ContactPoint& p, const lie::Motion& bi, const lie::Motion& bj)
{
    const Vec3 v = dae::velocity_at(bj, p.C_j - bj.r) - dae::velocity_at(bi, p.C_i - bi.r);
    return (v - v.dot(p.n) * p.n).norm();
}

ContactOutput geometry(const contact::ContactPoint& p, const lie::Motion& bi, const lie::Motion& bj)
{
    return {.gap = p.gap, .C = p.C(), .n = p.n, .slip = slip_speed(p, bi, bj)};
}

void add_friction(const contact::TrackedForce& force, const contact::TrackedForce::Instant& now,
                  const lie::State& x, ContactOutput& out)
{
    const contact::Wrench friction = force.friction(now, x);
    out.F = friction.F, out.T = friction.T_i;
    out.slipping = now.history.deflections.slide.slipping;
    out.rolling = now.history.deflections.roll_i.slipping || now.history.deflections.roll_j.slipping;
}

/// The resultant force of several contact points, at their centre of pressure
ContactOutput resultant(const std::vector<contact::LoadedPoint>& points, const lie::Motion& bi,
                        const lie::Motion& bj)
{
    ContactOutput out;
    out.gap = std::numeric_limits<double>::infinity();
    Vec3 normal = Vec3::Zero(), C = Vec3::Zero();
    bool slips = true;
    for (const contact::LoadedPoint& p : points) {
        if (p.at.gap < out.gap) out.gap = p.at.gap, out.n = p.at.n, out.C = p.at.C();
        if (!(p.N > 0)) continue;
        out.is_touching = true;
        out.F_N += p.N, normal += p.N * p.at.n, C += p.N * p.at.C(), out.F += p.F;
        out.slip = std::max(out.slip, slip_speed(p.at, bi, bj));
        slips = slips && p.slips;
    }
    if (!out.is_touching) return out;
    out.n = normal.normalized(), out.C = C / out.F_N, out.slipping = slips;
    for (const contact::LoadedPoint& p : points)
        if (p.N > 0) out.T += (p.at.C() - out.C).cross(p.F + p.N * (p.at.n - out.n)) + p.T;
    return out;
}

/// Columns of all contacts. The pairs of groups follow the other contacts.
class ContactColumns final : public ColumnGroup {
public:
    explicit ContactColumns(const dae::Model& model)
        : ColumnGroup(columns_of(names(model))), outputs(model), near(model.near_forces())
    {
        if (near.pairs() > ContactOutputs::most_pairs_with_columns) return;
        for (int n = 0; n < near.numbers(); ++n)
            if (const auto [group, pair] = near.group_of(n); group->has_pair(pair))
                pairs.emplace_back(n, near.force(n));
    }

    void values(const lie::State& x, double* out) override
    {
        const auto write = [&](const ContactOutput& now) {
            *out++ = now.F_N, *out++ = now.gap;
            for (const Vec3& v : {now.C, now.n, now.F, now.T})
                for (const double component : v) *out++ = component;
            *out++ = now.slip, *out++ = now.slipping, *out++ = now.rolling;
        };
        for (size_t k = 0; k < outputs.contacts.size(); ++k) write(outputs.at(k, x));
        if (pairs.empty()) return;
        const auto list = near.list(x);
        auto next = list->entry.begin();
        for (const auto& [number, far] : pairs) {
            while (next != list->entry.end() && next->number < number) ++next;
            const bool is_near = next != list->entry.end() && next->number == number;
            write(ContactOutputs::of(is_near ? *next->force : *far, x));
        }
    }

private:
    static std::vector<std::string> names(const dae::Model& model)
    {
        std::vector<std::string> all;
        for (const ContactOutputs::Contact& c : ContactOutputs(model).contacts) all.push_back(c.name);
        const dae::NearForces& near = model.near_forces();
        if (near.pairs() > ContactOutputs::most_pairs_with_columns) return all;
        for (int n = 0; n < near.numbers(); ++n)
            if (const auto [group, pair] = near.group_of(n); group->has_pair(pair)) {
                const auto [i, j] = group->bodies(pair);
                all.push_back(contact::ContactPairs::name_of_pair(
                    model, dynamic_cast<const contact::ContactGroup&>(*group).name, i, j));
            }
        return all;
    }

    static std::vector<dae::Quantity> columns_of(const std::vector<std::string>& names)
    {
        std::vector<dae::Quantity> all;
        for (const std::string& contact : names) {
            const auto add = [&](const char* name, const char* unit, const char* meaning) {
                all.push_back({contact + '.' + name, unit, meaning});
            };
            const auto vector = [&](const std::string& name, const char* unit, const char* meaning) {
                for (const char* axis : {"x", "y", "z"}) add((name + axis).c_str(), unit, meaning);
            };
            add("F_N", "N", "normal force, positive in compression, 0 without contact");
            add("gap", "m", "distance of the surfaces, negative for an overlap");
            vector("C", "m", "contact point, global frame");
            vector("n", "1", "unit normal, pointing into body i, global frame");
            vector("Ff_", "N", "friction force on body i, global frame");
            vector("Tf_", "N m", "friction torque on body i about the contact point, global frame");
            add("slip", "m/s", "tangential speed of body j relative to body i at the contact point");
            add("slipping", "1", "1 while the sliding friction is at its bound, else 0");
            add("rolling", "1", "1 while the rolling friction is at its bound; 1 with ideal rolling");
        }
        return all;
    }

    const ContactOutputs outputs;
    const dae::NearForces& near;
    /// Numbers of the pairs of groups, and their forces while they are not near
    std::vector<std::pair<int, std::shared_ptr<const dae::Force>>> pairs;
};

}  // namespace

ContactOutputs::ContactOutputs(const dae::Model& model) : model(model)
{
    const auto add_compliant = [&](const auto& c) {
        contacts.push_back({.name = c.name,
                            .i = c.i,
                            .j = c.j,
                            .shape_i = c.contact.i,
                            .shape_j = c.contact.j,
                            .compliant = &c});
    };
    for (const auto& force : model.forces())
        if (const auto* c = dynamic_cast<const contact::ContactForce*>(force.get());
            c != nullptr && c->normal_constraint() == nullptr)
            add_compliant(*c);
        else if (const auto* m = dynamic_cast<const contact::ManifoldForce*>(force.get()))
            add_compliant(*m);
    for (const contact::EvolvingContact* c : evolving_contacts(model)) {
        contacts.push_back({.name = c->name,
                            .i = c->i,
                            .j = c->j,
                            .shape_i = c->shape_i,
                            .shape_j = c->shape_j,
                            .constraint = c});
        for (const auto& force : model.forces()) {
            const auto* tracked = dynamic_cast<const contact::TrackedForce*>(force.get());
            if (tracked == nullptr || tracked->normal_constraint() != c) continue;
            if (const auto* friction = dynamic_cast<const contact::EvolvingFriction*>(tracked))
                contacts.back().friction = friction;
            else
                contacts.back().compliant = dynamic_cast<const contact::ContactForce*>(tracked);
        }
    }
    auto others = static_cast<size_t>(std::max(0, model.near_forces().numbers()));
    for (const auto& rigid : model.rigid_contacts())
        if (const auto* of = dynamic_cast<const contact::RigidContacts*>(rigid.get())) add_rigid(*of, others);
}

void ContactOutputs::add_rigid(const contact::RigidContacts& of, size_t& others)
{
    if (of.pairs().count() > most_rigid_pairs_with_columns) {
        rigid_groups.emplace_back(&of, others);
        others += static_cast<size_t>(of.numbers());
        return;
    }
    for (int pair = 0; pair < of.numbers(); ++pair)
        if (of.pairs().has(pair)) {
            const auto [i, j] = of.pairs().pair(pair);
            contacts.push_back({.name = of.name_of_pair(pair),
                                .i = i,
                                .j = j,
                                .shape_i = of.shape_i,
                                .shape_j = of.shape_j,
                                .rigid = &of,
                                .pair = pair});
        }
}

ContactOutput ContactOutputs::of(const contact::RigidContacts& contacts, int pair, const lie::State& x)
{
    static thread_local std::vector<contact::LoadedPoint> points;
    contacts.points(x, pair, points);
    const auto [i, j] = contacts.pairs().pair(pair);
    const lie::Motion &bi = dae::motion(x, i), &bj = dae::motion(x, j);
    return points.empty() ? geometry(contacts.nearest(x, pair), bi, bj) : resultant(points, bi, bj);
}

ContactOutput ContactOutputs::of(const dae::Force& force, const lie::State& x)
{
    const auto [i, j] = force.bodies();
    const lie::Motion &bi = dae::motion(x, i), &bj = dae::motion(x, j);
    if (const auto* several = dynamic_cast<const contact::ManifoldForce*>(&force)) {
        static thread_local std::vector<contact::LoadedPoint> points;
        several->points(x, points);
        return points.empty() ? geometry(several->nearest(x), bi, bj) : resultant(points, bi, bj);
    }
    const auto& single = dynamic_cast<const contact::ContactForce&>(force);
    const contact::ContactForce::Instant now = single.at(x);
    ContactOutput out = geometry(now.contact_state.contact_point, bi, bj);
    if (!(now.contact_state.N > 0)) return out;
    out.F_N = now.contact_state.N, out.is_touching = true;
    add_friction(single, now, x, out);
    return out;
}

ContactOutput ContactOutputs::at(size_t k, const lie::State& x) const
{
    const Contact& c = contacts[k];
    if (c.rigid != nullptr) return of(*c.rigid, c.pair, x);
    const auto* fallback = dynamic_cast<const contact::TrackedForce*>(c.compliant);
    if (c.compliant != nullptr && (fallback == nullptr || fallback->is_active(x))) return of(*c.compliant, x);
    return of_constraint(c, x);
}

ContactOutput ContactOutputs::of_constraint(const Contact& c, const lie::State& x) const
{
    const contact::EvolvingContact& constraint = *c.constraint;
    const dae::Constraint::Arguments at = model.arguments(constraint, x);
    ContactOutput out = geometry(constraint.contact_point(at), at.bi, at.bj);
    if (dae::Model::inactive(constraint, x)) return out;
    const contact::EvolvingContact::Multipliers of = constraint.multipliers(at, x.lambda);
    out.F_N = of.F_N, out.F = of.friction, out.is_touching = true;
    out.rolling = constraint.friction == contact::EvolvingContact::Friction::rolling;
    if (constraint.friction == contact::EvolvingContact::Friction::implicit) {
        const auto state = contact::restored<contact::EvolvingContact::NodeState>(at.internal_state);
        out.slipping = state.sliding.slipping != 0, out.rolling = state.rolling.slipping != 0;
        if (of.resistance != Eigen::Vector2d::Zero()) {  // the rows of rolling resistance are a couple
            derivatives.set_zero(constraint);
            constraint.variation(at, derivatives);
            const auto rows = (c.i == dae::ground ? derivatives.C_j : derivatives.C_i).block<2, 3>(9, 3);
            const Vec3 couple = -rows.transpose() * of.resistance;
            out.T = c.i == dae::ground ? Vec3(-at.bj.A * couple) : Vec3(at.bi.A * couple);
        }
    }
    if (c.friction != nullptr) add_friction(*c.friction, c.friction->at(x), x, out);
    return out;
}

std::unique_ptr<ColumnGroup> contact_columns(const dae::Model& model)
{
    return std::make_unique<ContactColumns>(model);
}

}  // namespace hilda::run
