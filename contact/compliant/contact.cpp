// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/compliant/contact.hpp"

#include "lie/check.hpp"

#include <algorithm>

namespace hilda::contact {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double nearby = 1e-6;         // a gap, over the same, that is none
constexpr double deepest = 0.1;         // overlap at a start, over a radius of curvature
constexpr double no_curvature = 1e-12;  // over the size of the curvatures: rounding

Vec3 velocity(const Motion& b, const Vec3& C) { return b.rdot + (b.A * b.omega_bar).cross(C - b.r); }

/// "what, got value unit"
std::string got(const std::string& what, double value, const std::string& unit)
{
    std::ostringstream text;
    text.precision(6);
    text << what << ", got " << value << ' ' << unit;
    return text.str();
}

}  // namespace

CompliantContact::CompliantContact(std::string name, Shape i, Shape j, Inertia of_i, Inertia of_j,
                          std::shared_ptr<const NormalLaw> law, std::shared_ptr<const FrictionModel> friction)
    : FrictionPair(std::move(name), std::move(i), std::move(j), std::move(of_i), std::move(of_j),
                   std::move(friction)),
      law(std::move(law)), detector(make_detector(this->i, this->j)),
      m_normal(reduced(this->of_i.m, this->of_j.m))
{}

NormalInput CompliantContact::normal_input(const ContactPoint& contact_point, const Motion& bi,
                                           const Motion& bj) const
{
    const Vec3 C = contact_point.C();
    return {.overlap = -contact_point.gap,
            .overlap_rate = contact_point.n.dot(velocity(bj, C) - velocity(bi, C)),
            .curvature = 0.5 * (contact_point.K_i.trace() + contact_point.K_j.trace()),
            .m = m_normal};
}

ContactPoint CompliantContact::find(const Motion& bi, const Motion& bj, const ContactHistory& history) const
{
    const Points last{history.contact_frame.c_i, history.contact_frame.c_j};
    try {
        return detector->detect(bi, bj, history.found ? &last : nullptr);
    } catch (const lie::NumericalFailure& e) {
        rethrow(e);
    }
}

ContactState CompliantContact::without_slip(const ContactPoint& contact_point, const Motion& bi,
                                            const Motion& bj) const
{
    ContactState now;
    now.contact_point = contact_point;
    now.N = law->force(normal_input(contact_point, bi, bj));
    now.slip = no_slip(contact_point, contact_point.n.unitOrthogonal());
    set_fictitious(now, bi, bj);
    return now;
}

ContactState CompliantContact::evaluate(const Motion& bi, const Motion& bj,
                                        const ContactHistory& history) const
{
    const ContactPoint contact_point = find(bi, bj, history);
    return contact_state(contact_point, law->force(normal_input(contact_point, bi, bj)), bi, bj, history);
}

bool CompliantContact::close(const Motion& bi, const Motion& bj, const ContactHistory& history) const
{
    return find(bi, bj, history).gap <= nearby * (std::isfinite(length) ? length : 1);
}

ContactState CompliantContact::hardest(const Motion& bi, const Motion& bj, const ContactHistory& history,
                                       double weight) const
{
    ContactPoint contact_point = find(bi, bj, history);
    NormalInput p = normal_input(contact_point, bi, bj);
    const double gap = std::max(contact_point.gap, 0.), approach = std::max(p.overlap_rate, 0.);
    const double first = std::max(p.overlap, 0.);
    p.overlap = first;
    const double given =
        law->energy(p) + weight * gap + (std::isfinite(p.m) ? 0.5 * p.m * approach * approach : 0);
    const auto beyond = [&](double overlap) {
        p.overlap = overlap;
        return law->energy(p) > given + weight * (overlap - first);
    };
    constexpr double shortest = 1e-12, longest = 1e3;  // [m]
    double lower = std::max(first, shortest), upper = lower;
    while (!beyond(upper) && upper < longest) lower = upper, upper *= 2;
    if (upper >= longest) lower = upper = first;  // no spring
    while (upper > lower * (1 + 1e-6)) {
        const double middle = 0.5 * (lower + upper);
        (beyond(middle) ? upper : lower) = middle;
    }
    contact_point.gap = -upper;
    const Motion still_i{.r = bi.r, .A = bi.A}, still_j{.r = bj.r, .A = bj.A};
    return without_slip(contact_point, still_i, still_j);
}

std::string CompliantContact::objection(const Motion& bi, const Motion& bj) const
{
    ContactPoint contact_point;
    try {
        contact_point = detector->detect(bi, bj, nullptr);
    } catch (const NoUniqueContactPoint& e) {
        return e.what();
    } catch (const lie::NumericalFailure& e) {
        rethrow(e);
    }
    double least = least_curvature(contact_point);
    const double mean = 0.5 * (contact_point.K_i + contact_point.K_j).trace();
    const double rounding = no_curvature * (contact_point.K_i.norm() + contact_point.K_j.norm());
    if (std::abs(least) <= rounding) least = 0;
    if (least < 0)
        return got("a surface does not fit into the other: the sum of their curvatures must not be negative",
                   least, "1/m");
    // a coin that hovers flat leans before it touches; a foot on a plane never curves
    const bool may_curve = contact_point.gap > 0 && (i.surface->size() > 0 || j.surface->size() > 0);
    if (mean <= rounding && !may_curve && (law->needs_curvature() || friction->needs_curvature()))
        return got("rolling and spinning friction need curvature: the sum of the curvatures must be positive",
                   mean, "1/m");
    const auto too_deep = [&](const Surface& surface, const Mat3& K) {
        const auto [less, more] = principal_curvatures(K, contact_point.n);
        const double curvature = std::max(std::abs(less), std::abs(more));
        const double radius = curvature > rounding ? 1 / curvature : infinite;
        // where it is flat its size tells how deep is deep
        const double size = surface.size() > 0 ? surface.size() : infinite;
        const bool round = radius <= size * (1 + 1e-9);
        const double length = round ? radius : size;
        if (!(-contact_point.gap > deepest * length)) return std::string();
        std::ostringstream what;
        what << "the surfaces must not overlap by more than a tenth of "
             << (round ? "a radius of curvature, " : "the size of one, ") << length << " m";
        return got(what.str(), -contact_point.gap, "m");
    };
    if (const std::string why = too_deep(*i.surface, contact_point.K_i); !why.empty()) return why;
    if (const std::string why = too_deep(*j.surface, contact_point.K_j); !why.empty()) return why;
    return {};
}

double CompliantContact::stable_step(const ContactState& now, const Motion& bi, const Motion& bj,
                                     int contacts_of_i, int contacts_of_j) const
{
    const NormalInput p = normal_input(now.contact_point, bi, bj);
    return FrictionPair::stable_step(now, {.K = law->stiffness(p), .D = p.overlap > 0 ? law->damping(p) : 0},
                                     bi, bj, contacts_of_i, contacts_of_j);
}

}  // namespace hilda::contact
