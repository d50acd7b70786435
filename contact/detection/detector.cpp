// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/detection/detector.hpp"

#include "contact/detection/detectors.hpp"
#include "contact/surfaces/cylinder.hpp"
#include "contact/surfaces/plane.hpp"
#include "lie/check.hpp"

#include <utility>

namespace hilda::contact {

namespace {

/// The detector of the pair (j, i), used for (i, j)
class ExchangedDetector final : public Detector {
public:
    explicit ExchangedDetector(std::unique_ptr<Detector> ji) : ji(std::move(ji)) {}

    ContactPoint detect(const Motion& bi, const Motion& bj, const PreviousPoints* from) const override
    {
        return detect_exchanged(*ji, bi, bj, from);
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
        if (!a->surface->is_smooth() && !b_is_plane)
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
    std::swap(contact_point.C_i, contact_point.C_j);
    std::swap(contact_point.K_i, contact_point.K_j);
    std::swap(contact_point.edge_i, contact_point.edge_j);
    contact_point.n = -contact_point.n;
    return contact_point;
}

std::unique_ptr<Detector> make_detector(const Shape& i, const Shape& j)
{
    check_shape(i), check_shape(j);
    check_pair(i, j);
    for (const auto make : {sphere_plane, sphere_sphere, foot_plane, disk_plane, cylinder_cylinder,
                            support_plane, common_normal}) {
        if (auto detector = make(i, j)) return detector;
        if (auto detector = make(j, i)) return std::make_unique<ExchangedDetector>(std::move(detector));
    }
    throw std::logic_error("common_normal accepts every pair");
}

}  // namespace hilda::contact
