// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/compliant/contact.hpp"

#include "dae/body.hpp"
#include "io/json.hpp"
#include "lie/check.hpp"

#include <algorithm>

namespace hilda::contact {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double contact_tolerance = 1e-6;  // largest gap of is_near_contact(), relative to the smaller size
// largest overlap at the start, relative to a radius of curvature or to the size
constexpr double max_relative_overlap = 0.1;
// a curvature below this is counted as zero, relative to the curvatures of the two surfaces
constexpr double no_curvature = 1e-12;

/// "what, got value unit"
std::string got(const std::string& what, double value, const std::string& unit)
{
    std::ostringstream text;
    text.precision(6);
    text << what << ", got " << value << ' ' << unit;
    return text.str();
}

/// The length [m] to which the overlap of a surface is compared: the radius of curvature, or the size where
/// the surface is flatter
struct ReferenceLength {
    double length;
    bool round;  ///< the length is the radius of curvature
};
ReferenceLength reference_length(const Surface& surface, const Mat3& K, const ContactPoint& at)
{
    const double rounding = no_curvature * (at.K_i.norm() + at.K_j.norm());
    const auto [kappa_1, kappa_2] = principal_curvatures(K, at.n);
    const double curvature = std::max(std::abs(kappa_1), std::abs(kappa_2));
    const double radius = curvature > rounding ? 1 / curvature : infinite;
    const double size = surface.size() > 0 ? surface.size() : infinite;
    const bool round = radius <= size * (1 + 1e-9);
    return {round ? radius : size, round};
}

}  // namespace

CompliantContact::CompliantContact(std::string name, Shape i, Shape j, Inertia inertia_i, Inertia inertia_j,
                                   std::shared_ptr<const NormalLaw> law,
                                   std::shared_ptr<const FrictionModel> friction)
    : FrictionPair(std::move(name), std::move(i), std::move(j), std::move(inertia_i), std::move(inertia_j),
                   std::move(friction)),
      law(std::move(law)), detector(make_detector(this->i, this->j)),
      m_normal(reduced(this->inertia_i.m, this->inertia_j.m))
{}

NormalInput CompliantContact::normal_input(const ContactPoint& contact_point, const Motion& bi,
                                           const Motion& bj) const
{
    const Vec3 C = contact_point.C();
    const double overlap_rate =
        contact_point.n.dot(dae::velocity_at(bj, C - bj.r) - dae::velocity_at(bi, C - bi.r));
    return {.overlap = -contact_point.gap,
            .overlap_rate = overlap_rate,
            .curvature = 0.5 * (contact_point.K_i.trace() + contact_point.K_j.trace()),
            .m = m_normal};
}

ContactPoint CompliantContact::detect(const Motion& bi, const Motion& bj, const ContactHistory& history) const
{
    const PreviousPoints last{history.contact_frame.c_i, history.contact_frame.c_j};
    try {
        return detector->detect(bi, bj, history.has_points ? &last : nullptr);
    } catch (const lie::NumericalFailure& e) {
        rethrow(e);
    }
}

void CompliantContact::contact_points(const Motion& bi, const Motion& bj, double reach, Manifold& out) const
{
    try {
        detector->detect_all(bi, bj, reach, out);
    } catch (const lie::NumericalFailure& e) {
        rethrow(e);
    }
}

ContactState CompliantContact::state_without_history(const ContactPoint& contact_point, const Motion& bi,
                                                     const Motion& bj, double share) const
{
    ContactState now;
    now.share = share;
    now.contact_point = contact_point;
    now.N = law->force(normal_input(contact_point, bi, bj));
    now.slip = zero_displacement(contact_point, contact_point.n.unitOrthogonal());
    set_fictitious_inertia(now, bi, bj);
    return now;
}

ContactState CompliantContact::evaluate(const Motion& bi, const Motion& bj,
                                        const ContactHistory& history) const
{
    return evaluate_at(detect(bi, bj, history), bi, bj, history);
}

ContactState CompliantContact::evaluate_at(const ContactPoint& contact_point, const Motion& bi,
                                           const Motion& bj, const ContactHistory& history,
                                           double share) const
{
    const double N = law->force(normal_input(contact_point, bi, bj));
    if (!std::isfinite(N))
        throw lie::NonFinite("contact '" + name + "': the normal force is not finite at an overlap of " +
                             io::shortest(-contact_point.gap) + " m");
    ContactState now = contact_state(contact_point, N, bi, bj, history);
    now.share = share;
    return now;
}

double CompliantContact::nearly_touching() const
{
    return contact_tolerance * (std::isfinite(smaller_size) ? smaller_size : 1);
}

bool CompliantContact::is_near_contact(const Motion& bi, const Motion& bj,
                                       const ContactHistory& history) const
{
    return detect(bi, bj, history).gap <= nearly_touching();
}

ContactState CompliantContact::state_at_largest_compression(const Motion& bi, const Motion& bj,
                                                            const ContactHistory& history,
                                                            double weight) const
{
    ContactPoint contact_point = detect(bi, bj, history);
    NormalInput p = normal_input(contact_point, bi, bj);
    const double gap = std::max(contact_point.gap, 0.), approach = std::max(p.overlap_rate, 0.);
    const double initial = std::max(p.overlap, 0.);
    p.overlap = initial;
    const double available_energy =
        law->energy(p) + weight * gap + (std::isfinite(p.m) ? 0.5 * p.m * approach * approach : 0);
    const auto exceeds = [&](double overlap) {
        p.overlap = overlap;
        return law->energy(p) > available_energy + weight * (overlap - initial);
    };
    constexpr double shortest = 1e-12, longest = 1e3;  // [m]
    // solve energy(δ) = available energy + weight (δ - initial) for δ: bracket, then bisect
    double lower = std::max(initial, shortest), upper = lower;
    while (!exceeds(upper) && upper < longest) lower = upper, upper *= 2;
    if (upper >= longest) lower = upper = initial;  // the law has no spring
    while (upper > lower * (1 + 1e-6)) {
        const double middle = 0.5 * (lower + upper);
        (exceeds(middle) ? upper : lower) = middle;
    }
    contact_point.gap = -upper;
    const Motion still_i{.r = bi.r, .A = bi.A}, still_j{.r = bj.r, .A = bj.A};
    return state_without_history(contact_point, still_i, still_j);
}

std::string CompliantContact::start_error(const Motion& bi, const Motion& bj) const
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
        return got(
            "one surface does not fit into the other: the sum of their curvatures must not be negative",
            least, "1/m");
    // Surfaces that are still apart may have positive curvature when they come into contact: a disk parallel
    // to the plane has zero curvature, but usually touches it tilted. A foot and a plane, both of size 0,
    // have zero curvature always.
    const bool may_curve = contact_point.gap > 0 && (i.surface->size() > 0 || j.surface->size() > 0);
    if (mean <= rounding && !may_curve && (law->needs_curvature() || friction->needs_curvature()))
        return got("the normal or friction law needs curvature: the sum of the curvatures must be positive",
                   mean, "1/m");
    const auto too_deep = [&](const Surface& surface, const Mat3& K) {
        const auto [length, round] = reference_length(surface, K, contact_point);
        if (!(-contact_point.gap > max_relative_overlap * length)) return std::string();
        std::ostringstream what;
        what << "the surfaces must not overlap by more than " << max_relative_overlap * length
             << " m, a tenth of " << (round ? "the radius of curvature " : "the size ") << length << " m";
        return got(what.str(), -contact_point.gap, "m");
    };
    if (std::string why = too_deep(*i.surface, contact_point.K_i); !why.empty()) return why;
    if (std::string why = too_deep(*j.surface, contact_point.K_j); !why.empty()) return why;
    return {};
}

double CompliantContact::relative_overlap(const ContactPoint& at) const
{
    return -at.gap / std::min(reference_length(*i.surface, at.K_i, at).length,
                              reference_length(*j.surface, at.K_j, at).length);
}

NormalSupport CompliantContact::normal_support(const ContactState& now, const Motion& bi,
                                               const Motion& bj) const
{
    const NormalInput p = normal_input(now.contact_point, bi, bj);
    return {.K = now.share * law->stiffness(p), .D = p.overlap > 0 ? now.share * law->damping(p) : 0};
}

double CompliantContact::stable_step(const ContactState& now, const Motion& bi, const Motion& bj,
                                     ContactCounts contacts, double damping_factor) const
{
    return FrictionPair::stable_step(now, normal_support(now, bi, bj), bi, bj, contacts, damping_factor);
}

bool CompliantContact::is_stable(double h, double damping_factor, const ContactState& now, const Motion& bi,
                                 const Motion& bj, ContactCounts contacts) const
{
    return FrictionPair::is_stable(h, damping_factor, now, normal_support(now, bi, bj), bi, bj, contacts);
}

}  // namespace hilda::contact
