// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surfaces/cone.hpp"

#include "contact/surface_types.hpp"
#include "contact/surfaces/positive.hpp"

#include <numbers>

namespace hilda::contact {

namespace {

bool angle_allowed(double beta) { return beta > 0 && beta < std::numbers::pi / 2; }

double checked_angle(double beta)
{
    if (!angle_allowed(beta))
        lie::reject("contact::Cone", "the half angle of a cone must be between 0 and pi/2", beta);
    return beta;
}

}  // namespace

Cone::Cone(double half_angle, bool concave)
    : half_angle(checked_angle(half_angle)), concave(concave), sine(std::sin(half_angle)),
      cosine(std::cos(half_angle))
{}

double Cone::value(const Vec3& a) const { return cosine * a.head<2>().norm() - sine * a.z(); }

Vec3 Cone::gradient(const Vec3& a) const
{
    const double rho = a.head<2>().norm();
    return {cosine * a.x() / rho, cosine * a.y() / rho, -sine};
}

Mat3 Cone::hessian(const Vec3& a) const
{
    const double rho = a.head<2>().norm();
    const Vec3 around(-a.y() / rho, a.x() / rho, 0);
    const Mat3 across = around * around.transpose();
    return cosine / rho * across;
}

Vec3 Cone::project(const Vec3& a) const
{
    const double rho = a.head<2>().norm(), along = sine * rho + cosine * a.z();
    if (!(rho > 0))
        throw lie::NumericalFailure("contact_not_converged",
                                    "a point on the axis of a cone has no unique closest point");
    if (!(along > 0)) {
        std::ostringstream what;
        what.precision(6);
        what << "the closest point of a cone to (" << a.x() << ", " << a.y() << ", " << a.z()
             << ") is its apex, where the normal is undefined";
        throw lie::NumericalFailure("contact_not_converged", what.str());
    }
    return along * Vec3(sine * a.x() / rho, sine * a.y() / rho, cosine);
}

namespace {

const bool registered_cone = io::Registry<SurfaceType>::add(
    {.name = "cone",
     .schema = {.description =
                    "Infinite circular cone. Its apex is at the origin of the surface frame and it "
                    "opens along z. The apex itself cannot be a contact point.",
                .examples = {R"("half_angle": 0.5, "concave": true, "axis": [0, 0, 1])"}},
     .read = [](dae::ObjectReader& o) -> std::shared_ptr<const Surface> {
         const double beta =
             o.number("half_angle", {"Angle between axis and side [rad].", "0.5",
                                     R"("exclusiveMinimum": 0, "exclusiveMaximum": 1.5707963267948966)"});
         if (!angle_allowed(beta))
             o.fail("half_angle", "half_angle must be between 0 and pi/2, got " + dae::shortest(beta));
         return std::make_shared<Cone>(beta, read_concave(o));
     },
     .z = "axis"});

}  // namespace

}  // namespace hilda::contact
