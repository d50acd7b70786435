// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/stages/take_over.hpp"

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

/// The motion of a boundary; one without formulas is added if there is none.
BoundaryMotion& motion_of(Case& c, int boundary)
{
    for (BoundaryMotion& m : *c.motions)
        if (m.boundary == boundary) return m;
    BoundaryMotion none;
    none.boundary = boundary, none.name = c.boundaries[static_cast<std::size_t>(boundary)];
    return c.motions->emplace_back(std::move(none));
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

void take_over_motions(Case& c, const Case& changed, const std::vector<std::string>& pointers, double start)
{
    BoundaryMotion none;
    for (int b = 0; b < static_cast<int>(c.boundaries.size()); ++b)
        for (const auto& [key, formula] : keys_of_motion) {
            if (!includes(pointers, entry_of(c, b) + '/' + key)) continue;
            const BoundaryMotion* now = &none;
            for (const BoundaryMotion& m : *changed.motions)
                if (m.boundary == b) now = &m;
            motion_of(c, b).*formula = from(start, now->*formula);
        }
}

void check_laws(const Case& c, const Case& changed)
{
    const std::vector<PairLaw>&before = c.world->all_laws(), &now = changed.world->all_laws();
    for (std::size_t k = 0; k < now.size(); ++k) {
        const PairLaw &a = before[k], &b = now[k];
        for (const auto& [kind, is_same] : {std::pair{"normal", a.normal.is_same_law(b.normal)},
                                            {"tangential", a.tangential.is_same_law(b.tangential)},
                                            {"rolling", a.rolling.is_same_law(b.rolling)},
                                            {"spin", a.spin.is_same_law(b.spin)},
                                            {"cohesion", a.cohesion.is_same_law(b.cohesion)}})
            if (!is_same)
                changed.source.fail(
                    "/laws/" + std::to_string(k) + '/' + kind,
                    std::string("the ") + kind + " law must be that of the run, only its numbers can change");
    }
}

/// Throws io::PlacedError if a boundary is not where its new formula begins.
void check_place(const Case& c, const Case& changed, const BoundaryMotion& m)
{
    const World& w = *c.world;
    const Boundary& b = w.all_boundaries()[static_cast<std::size_t>(m.boundary)];
    const Vec3 r = (*m.r)(w.t()), d = r - b.r;
    const auto off = [&](int axis, double x) { return b.mass > 0 && b.free[axis] ? 0 : x; };
    const double distance = Vec3{off(0, d.x), off(1, d.y), off(2, d.z)}.norm();
    if (distance <= 1e-6 * (w.high() - w.low()).norm()) return;
    changed.source.fail(
        entry_of(c, m.boundary) + "/r",
        io::formatted(
            "the formula must begin at the place of the boundary at t = %.9g s, (%.9g, %.9g, %.9g) m, "
            "got (%.9g, %.9g, %.9g)",
            w.t(), b.r.x, b.r.y, b.r.z, r.x, r.y, r.z));
}

/// Throws io::PlacedError if numbers of v or omega have a part along or about a free axis, where the loads
/// determine the motion.
void check_velocities(const Case& c, const Case& changed, const std::vector<std::string>& pointers)
{
    for (int number = 0; number < static_cast<int>(c.boundaries.size()); ++number) {
        const Boundary& b = changed.world->all_boundaries()[static_cast<std::size_t>(number)];
        if (!(b.mass > 0)) continue;
        const auto check = [&](const char* key, const Vec3& value, int first) {
            const std::string pointer = entry_of(c, number) + '/' + key;
            const double of[] = {value.x, value.y, value.z};
            for (int axis = 0; axis < 3; ++axis)
                if (includes(pointers, pointer) && b.free[first + axis] && of[axis] != 0)
                    changed.source.fail(
                        pointer, io::formatted("%s of a tool can be changed along the axes that are not "
                                               "free only, it must be 0 along %c, got %.9g",
                                               key, 'x' + axis, of[axis]));
        };
        check("v", b.v, 0);
        if (!b.inertia.is_zero()) check("omega", b.omega, 3);
    }
}

/// Sets the velocities and loads that are numbers.
void set_numbers(Case& c, const Case& changed, const std::vector<std::string>& pointers)
{
    for (int number = 0; number < static_cast<int>(c.boundaries.size()); ++number) {
        const auto is_changed = [&](const char* key) {
            return includes(pointers, entry_of(c, number) + '/' + key);
        };
        const BoundaryMotion& m = motion_of(c, number);
        const Boundary& now = changed.world->all_boundaries()[static_cast<std::size_t>(number)];
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

void take_over(Case& c, const Case& changed, const std::vector<std::string>& pointers, double start)
{
    check_laws(c, changed);
    check_velocities(c, changed, pointers);
    if (includes(pointers, "/gravity")) c.world->set_gravity(changed.world->gravity());
    if (includes(pointers, "/laws")) c.world->set_laws(changed.world->all_laws());
    take_over_motions(c, changed, pointers, start);
}

void begin_change(Case& c, const Case& changed, const std::vector<std::string>& pointers)
{
    for (const BoundaryMotion& m : *c.motions)
        if (m.r && includes(pointers, entry_of(c, m.boundary) + "/r")) check_place(c, changed, m);
    set_numbers(c, changed, pointers);
    if (c.insertions != nullptr)
        for (std::size_t k = 0; k < c.insertions->all.size(); ++k)
            c.insertions->all[k].begin_flow(changed.insertions->all[k].what().flow, c.world->t());
    c.world->start_balance();
}

}  // namespace hilda::granular
