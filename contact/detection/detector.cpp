// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/detection/detector.hpp"

#include "contact/detection/detectors.hpp"
#include "contact/surfaces/cylinder.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/polytope.hpp"
#include "lie/check.hpp"

#include <algorithm>
#include <utility>

namespace hilda::contact {

namespace {

void exchange(ContactPoint& p)
{
    std::swap(p.C_i, p.C_j);
    std::swap(p.K_i, p.K_j);
    std::swap(p.edge_i, p.edge_j);
    p.n = -p.n;
}

/// The detector of the pair (j, i), used for (i, j)
class ExchangedDetector final : public Detector {
public:
    explicit ExchangedDetector(std::unique_ptr<Detector> ji) : ji(std::move(ji)) {}

    ContactPoint detect(const Motion& bi, const Motion& bj, const PreviousPoints* from) const override
    {
        return detect_exchanged(*ji, bi, bj, from);
    }
    void detect_all(const Motion& bi, const Motion& bj, double reach, Manifold& out) const override
    {
        ji->detect_all(bj, bi, reach, out);
        for (ManifoldPoint& p : out) exchange(p.at);
    }
    bool is_cheap() const override { return ji->is_cheap(); }

private:
    const std::unique_ptr<Detector> ji;
};

void check_shape(const Shape& shape)
{
    constexpr const char* where = "contact::make_detector";
    if (shape.surface == nullptr) lie::reject(where, "a shape must have a surface", "none");
    if (!shape.position.allFinite())
        lie::reject(where, "the position of a surface must be finite", shape.position.transpose());
    constexpr double tolerance = 1e-12;
    if (const double error = lie::orthogonality_error(shape.orientation); !(error <= tolerance))
        lie::reject(where, "the orientation of a surface must be a rotation: |A^T A - I| must be 0", error);
    if (!(shape.orientation.determinant() > 0))
        lie::reject(where, "the orientation of a surface must be a rotation", "a reflection");
}

std::string names(const Shape& i, const Shape& j)
{
    const auto named = [](const Shape& s) {
        return (s.surface->sigma() < 0 ? "concave " : "") + s.surface->name();
    };
    return named(i) + " and " + named(j);
}

/// Rejects the pairs of surfaces that never have a single contact point, and those without a detector.
void check_pair(const Shape& i, const Shape& j)
{
    constexpr const char* where = "contact::make_detector";
    for (const auto& [a, b] : {std::pair{&i, &j}, std::pair{&j, &i}}) {
        const bool a_is_plane = surface_as<Plane>(*a) != nullptr,
                   b_is_plane = surface_as<Plane>(*b) != nullptr;
        const bool is_polytope = surface_as<Polytope>(*a) != nullptr;
        if (is_polytope && !b_is_plane && surface_as<Polytope>(*b) == nullptr &&
            !is_smooth_convex_body(*b->surface))
            lie::reject(
                where,
                "a " + a->surface->name() +
                    " can be paired with a plane, sphere, box, capsule, polygon, convex, ellipsoid or "
                    "superquadric",
                names(i, j));
        if (!a->surface->is_smooth() && !is_polytope && !b_is_plane)
            lie::reject(where, "a " + a->surface->name() + " can be paired with a plane only", names(i, j));
        if (a_is_plane && (b_is_plane || surface_as<Cylinder>(*b) != nullptr))
            lie::reject(where, "a pair of surfaces must have a single contact point", names(i, j));
        if (a->surface->sigma() < 0 && (b_is_plane || b->surface->sigma() < 0))
            lie::reject(where, "a concave surface can be in contact on its inside only", names(i, j));
    }
}

}  // namespace

ContactPoint detect_exchanged(const Detector& ji, const Motion& bi, const Motion& bj,
                              const PreviousPoints* from)
{
    const PreviousPoints exchanged =
        from != nullptr ? PreviousPoints{from->c_j, from->c_i} : PreviousPoints{};
    ContactPoint contact_point = ji.detect(bj, bi, from != nullptr ? &exchanged : nullptr);
    exchange(contact_point);
    return contact_point;
}

void Manifold::sort()
{
    std::sort(begin(), end(),
              [](const ManifoldPoint& a, const ManifoldPoint& b) { return a.feature < b.feature; });
}

void Detector::detect_all(const Motion& bi, const Motion& bj, double reach, Manifold& out) const
{
    out.clear();
    const ContactPoint at = detect(bi, bj, nullptr);
    if (at.gap < reach) out.push_back({.at = at, .feature = 0});
}

std::unique_ptr<Detector> make_detector(const Shape& i, const Shape& j)
{
    check_shape(i), check_shape(j);
    check_pair(i, j);
    for (const auto make : {polytope_plane, polytope_polytope, polytope_smooth, sphere_plane, sphere_sphere,
                            foot_plane, disk_plane, cylinder_cylinder, support_plane, common_normal}) {
        if (auto detector = make(i, j)) return detector;
        if (auto detector = make(j, i)) return std::make_unique<ExchangedDetector>(std::move(detector));
    }
    throw std::logic_error("common_normal accepts every pair");
}

}  // namespace hilda::contact
