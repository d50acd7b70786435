// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/stages/case_parameters.hpp"

#include "granular/core/rigid_body.hpp"
#include "io/message.hpp"

#include <algorithm>

namespace hilda::granular {

namespace {

/// Whether one of the pointers is this one or below it
bool includes(const std::vector<std::string>& pointers, const std::string& pointer)
{
    return std::any_of(pointers.begin(), pointers.end(),
                       [&](const std::string& p) { return p == pointer || p.starts_with(pointer + '/'); });
}

std::string entry_of(const Case& c, int boundary)
{
    return "/boundaries/" + std::to_string(c.entry_of_boundary[static_cast<std::size_t>(boundary)]);
}

/// The motion of a boundary; one without formulas if there is none
BoundaryMotion motion_of(const std::vector<BoundaryMotion>& motions, const Case& c, int boundary)
{
    for (const BoundaryMotion& m : motions)
        if (m.boundary == boundary) return m;
    BoundaryMotion none;
    none.boundary = boundary, none.name = c.boundaries[static_cast<std::size_t>(boundary)];
    return none;
}

std::optional<VectorFormula> from(double start, std::optional<VectorFormula> f)
{
    if (f && start != 0)
        for (Formula& part : f->of) part = [f = std::move(part), start](double t) { return f(t - start); };
    return f;
}

constexpr std::pair<const char*, std::optional<VectorFormula> BoundaryMotion::*> keys_of_motion[] = {
    {"r", &BoundaryMotion::r},
    {"v", &BoundaryMotion::v},
    {"omega", &BoundaryMotion::omega},
    {"F", &BoundaryMotion::F},
    {"T", &BoundaryMotion::T}};

void set_motions(Case& c, const CaseParameters& changed, const std::vector<std::string>& pointers,
                 double start)
{
    std::vector<BoundaryMotion> all;
    for (int b = 0; b < static_cast<int>(c.boundaries.size()); ++b) {
        BoundaryMotion m = motion_of(*c.motions, c, b);
        const BoundaryMotion now = motion_of(changed.motions, c, b);
        for (const auto& [key, formula] : keys_of_motion)
            if (includes(pointers, entry_of(c, b) + '/' + key)) m.*formula = from(start, now.*formula);
        if (m.is_prescribed()) all.push_back(std::move(m));
    }
    *c.motions = std::move(all);  // the world has the address of the list
}

void check_laws(const Case& c, const CaseParameters& changed)
{
    const std::vector<PairLaw>&before = c.world->all_laws(), &now = changed.laws;
    for (std::size_t k = 0; k < now.size(); ++k) {
        const PairLaw &a = before[k], &b = now[k];
        for (const auto& [kind, is_same] : {std::pair{"normal", a.normal.is_same_law(b.normal)},
                                            {"tangential", a.tangential.is_same_law(b.tangential)},
                                            {"rolling", a.rolling.is_same_law(b.rolling)},
                                            {"spin", a.spin.is_same_law(b.spin)},
                                            {"cohesion", a.cohesion.is_same_law(b.cohesion)}})
            if (!is_same)
                c.source.fail(
                    "/laws/" + std::to_string(k) + '/' + kind,
                    std::string("the ") + kind + " law must be that of the run, only its numbers can change");
    }
}

/// Throws io::PlacedError if a boundary is not where its new formula begins.
void check_place(const Case& c, const BoundaryMotion& m)
{
    const World& w = *c.world;
    const Boundary& b = w.all_boundaries()[static_cast<std::size_t>(m.boundary)];
    const Vec3 r = (*m.r)(w.t()), d = r - b.r;
    const auto off = [&](int axis, double x) { return b.mass > 0 && b.free[axis] ? 0 : x; };
    const double distance = Vec3{off(0, d.x), off(1, d.y), off(2, d.z)}.norm();
    if (distance <= 1e-6 * (w.high() - w.low()).norm()) return;
    c.source.fail(
        entry_of(c, m.boundary) + "/r",
        io::formatted(
            "the formula must begin at the place of the boundary at t = %.9g s, (%.9g, %.9g, %.9g) m, "
            "got (%.9g, %.9g, %.9g)",
            w.t(), b.r.x, b.r.y, b.r.z, r.x, r.y, r.z));
}

/// Throws io::PlacedError if numbers of v or omega have a part along or about a free axis, where the loads
/// determine the motion.
void check_velocities(const Case& c, const CaseParameters& changed, const std::vector<std::string>& pointers)
{
    for (int number = 0; number < static_cast<int>(c.boundaries.size()); ++number) {
        const Boundary& b = c.world->all_boundaries()[static_cast<std::size_t>(number)];
        const CaseParameters::Numbers& now = changed.numbers[static_cast<std::size_t>(number)];
        if (!(b.mass > 0)) continue;
        const auto check = [&](const char* key, const Vec3& value, int first) {
            const std::string pointer = entry_of(c, number) + '/' + key;
            const double of[] = {value.x, value.y, value.z};
            for (int axis = 0; axis < 3; ++axis)
                if (includes(pointers, pointer) && b.free[first + axis] && of[axis] != 0)
                    c.source.fail(pointer,
                                  io::formatted("%s of a tool can be changed along the axes that are not "
                                                "free only, it must be 0 along %c, got %.9g",
                                                key, 'x' + axis, of[axis]));
        };
        check("v", now.v, 0);
        if (!b.inertia.is_zero()) check("omega", now.omega, 3);
    }
}

/// Sets the velocities and loads that are numbers.
void set_numbers(Case& c, const CaseParameters& changed, const std::vector<std::string>& pointers)
{
    for (int number = 0; number < static_cast<int>(c.boundaries.size()); ++number) {
        const auto is_changed = [&](const char* key) {
            return includes(pointers, entry_of(c, number) + '/' + key);
        };
        const BoundaryMotion m = motion_of(*c.motions, c, number);
        const CaseParameters::Numbers& now = changed.numbers[static_cast<std::size_t>(number)];
        Boundary& b = c.world->boundary(number);
        if ((is_changed("v") || is_changed("r")) && !m.v && !m.r) {
            const auto prescribed = [&](int axis) { return !(b.mass > 0 && b.free[axis]); };
            b.v = {prescribed(0) ? now.v.x : b.v.x, prescribed(1) ? now.v.y : b.v.y,
                   prescribed(2) ? now.v.z : b.v.z};
        }
        if (is_changed("omega") && !m.omega) prescribe_omega(b, now.omega);
        if (is_changed("F") && !m.F) b.F = now.F;
        if (is_changed("T") && !m.T) b.T = now.T;
    }
}

}  // namespace

CaseParameters parameters_of(const Case& c)
{
    CaseParameters all{.gravity = c.world->gravity(),
                       .laws = c.world->all_laws(),
                       .motions = *c.motions,
                       .numbers = {},
                       .flows = {},
                       .moving = c.moving};
    for (const Boundary& b : c.world->all_boundaries()) all.numbers.push_back({b.v, b.omega, b.F, b.T});
    if (c.insertions != nullptr)
        for (const Insertion& i : c.insertions->all) all.flows.push_back(i.what().flow);
    return all;
}

void check_parameters(const Case& c, const CaseParameters& changed, const std::vector<std::string>& pointers)
{
    check_laws(c, changed);
    check_velocities(c, changed, pointers);
}

void set_parameters(Case& c, const CaseParameters& changed, const std::vector<std::string>& pointers,
                    double start)
{
    if (includes(pointers, "/gravity")) c.world->set_gravity(changed.gravity);
    if (includes(pointers, "/laws")) c.world->set_laws(changed.laws);
    set_motions(c, changed, pointers, start);
}

void begin_change(Case& c, const CaseParameters& changed, const std::vector<std::string>& pointers)
{
    for (const BoundaryMotion& m : *c.motions)
        if (m.r && includes(pointers, entry_of(c, m.boundary) + "/r")) check_place(c, m);
    set_numbers(c, changed, pointers);
    for (std::size_t k = 0; k < changed.flows.size(); ++k)
        c.insertions->all[k].begin_flow(changed.flows[k], c.world->t());
    c.world->start_balance();
}

}  // namespace hilda::granular
