// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/detection/detector.hpp"

#include "contact/detection/detectors.hpp"
#include "contact/surfaces/cylinder.hpp"
#include "contact/surfaces/disk.hpp"
#include "contact/surfaces/foot.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/tangent_basis.hpp"
#include "lie/check.hpp"

#include <cmath>
#include <utility>

namespace hilda::contact {

namespace {

class Exchanged final : public Detector {
public:
    explicit Exchanged(std::unique_ptr<Detector> ji) : ji(std::move(ji)) {}

    ContactPoint detect(const Motion& bi, const Motion& bj, const Points* from) const override
    {
        return detect_exchanged(*ji, bi, bj, from);
    }

private:
    const std::unique_ptr<Detector> ji;
};

template <class S>
bool is(const Shape& shape)
{
    return dynamic_cast<const S*>(shape.surface.get()) != nullptr;
}

void check(const Shape& shape)
{
    constexpr const char* where = "contact::make_detector";
    if (shape.surface == nullptr) lie::reject(where, "a shape must have a surface", "none");
    if (!shape.position.allFinite())
        lie::reject(where, "the position of a surface must be finite", shape.position.transpose());
    constexpr double mended = 1e-12;
    if (const double error = lie::orthogonality_error(shape.orientation); !(error <= mended))
        lie::reject(where, "the orientation of a surface must be a rotation: |A^T A - I| must be 0", error);
    if (shape.orientation.determinant() < 0)
        lie::reject(where, "the orientation of a surface must be a rotation", "a reflection");
}

std::string names(const Shape& i, const Shape& j)
{
    const auto named = [](const Shape& s) {
        return (s.surface->sigma() < 0 ? "concave " : "") + s.surface->name();
    };
    return named(i) + " and " + named(j);
}

/// Refuses the pairs of which it is known that they touch in no point, or in many.
void refuse(const Shape& i, const Shape& j)
{
    constexpr const char* where = "contact::make_detector";
    for (const auto& [a, b] : {std::pair{&i, &j}, std::pair{&j, &i}}) {
        if (is<Foot>(*a) && !is<Plane>(*b)) lie::reject(where, "a foot touches planes only", names(i, j));
        if (is<Disk>(*a) && !is<Plane>(*b)) lie::reject(where, "a disk touches planes only", names(i, j));
        if (is<Plane>(*a) && (is<Plane>(*b) || is<Cylinder>(*b)))
            lie::reject(where, "a pair of surfaces must touch in a single point", names(i, j));
        if (a->surface->sigma() < 0 && (is<Plane>(*b) || b->surface->sigma() < 0))
            lie::reject(where, "a concave surface can be touched from inside only", names(i, j));
    }
}

}  // namespace

Curvatures principal_curvatures(const Mat3& K, const Vec3& n)
{
    const Eigen::Matrix<double, 3, 2> T = tangent_basis(n);
    const Eigen::Matrix2d S = T.transpose() * K * T;
    const double mean = 0.5 * S.trace(), off = std::hypot(0.5 * (S(0, 0) - S(1, 1)), S(0, 1));
    return {mean - off, mean + off};
}

double least_curvature(const ContactPoint& contact_point)
{
    return principal_curvatures(contact_point.K_i + contact_point.K_j, contact_point.n).least;
}

ContactPoint detect_exchanged(const Detector& ji, const Motion& bi, const Motion& bj, const Points* from)
{
    const Points exchanged = from != nullptr ? Points{from->c_j, from->c_i} : Points{};
    ContactPoint contact_point = ji.detect(bj, bi, from != nullptr ? &exchanged : nullptr);
    std::swap(contact_point.C_i, contact_point.C_j);
    std::swap(contact_point.K_i, contact_point.K_j);
    std::swap(contact_point.edge_i, contact_point.edge_j);
    contact_point.n = -contact_point.n;
    return contact_point;
}

std::unique_ptr<Detector> make_detector(const Shape& i, const Shape& j)
{
    check(i), check(j);
    refuse(i, j);
    for (const auto make : {sphere_plane, sphere_sphere, foot_plane, disk_plane, cylinder_cylinder,
                            support_plane, common_normal}) {
        if (auto detector = make(i, j)) return detector;
        if (auto detector = make(j, i)) return std::make_unique<Exchanged>(std::move(detector));
    }
    throw std::logic_error("common_normal takes every pair");
}

}  // namespace hilda::contact
