// SPDX-License-Identifier: GPL-3.0-or-later
// Impacts of a contact with ideal rolling whose normal does not point to the centre of mass.
#include "contact/evolving/unilateral.hpp"
#include "contact/surfaces/ellipsoid.hpp"
#include "contact/surfaces/plane.hpp"
#include "dae/model.hpp"
#include "dae/start.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"

#include <catch2/catch.hpp>
#include <random>

using namespace hilda;
using contact::EvolvingContact;
using contact::Shape;
using contact::Unilateral;
using lie::Mat3;
using lie::State;
using lie::Vec3;

namespace {

constexpr double m = 2, J = 0.045;  // [kg], [kg m²], the same about every axis
const Vec3 semi_axes(0.3, 0.25, 0.15);

/// Motion of an ellipsoid that flies onto a floor, without gravity, before and after the impact
struct Impact {
    lie::Motion before, after;
    Vec3 arm;               ///< from the centre of mass to the contact point at the impact
    bool happened = false;  ///< with a rebound

    Impact(Unilateral::Impact law, double e, unsigned seed)
    {
        dae::Model model;
        model.gravity.setZero();
        model.add({"stone", m, J * Mat3::Identity()});
        model.constrain("contact",
                        std::make_unique<EvolvingContact>(
                            0, Shape{std::make_shared<contact::Ellipsoid>(semi_axes)}, dae::ground,
                            Shape{std::make_shared<contact::Plane>()}, EvolvingContact::Friction::rolling,
                            EvolvingContact::NormalRows::tangent, Unilateral{true, e, law}));
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> u(-1, 1);
        const auto vector = [&] { return Vec3(u(random), u(random), u(random)); };
        State x;
        x.body.resize(1);
        x.body[0].A = lie::exp(Vec3(2 * vector()));
        x.body[0].r = {0, 0, 0.32};
        x.body[0].rdot = 2 * vector() - Vec3(0, 0, 3);
        x.body[0].omega_bar = 4 * vector();
        dae::start(model, x);
        contact::UnilateralStep step(model, lie::scheme("rA-half-1-momentum"), {.tolerance = 1e-13});
        double t = 0;
        while (step.events().empty() && x.t < 0.5) {
            before = x.body[0], t = x.t;
            step.step(x, 1e-3);
        }
        after = x.body[0];
        if (step.events().empty()) return;
        happened = step.events()[0].type == contact::ContactEvent::Type::impact;
        // the point of the ellipsoid with the normal -z
        const Mat3 A = before.A * lie::exp(Vec3((step.events()[0].t - t) * before.omega_bar)),
                   S = A * semi_axes.cwiseAbs2().asDiagonal() * A.transpose();
        arm = -S * Vec3::UnitZ() / std::sqrt(S(2, 2));
    }

    /// Velocity of the contact point
    Vec3 velocity(const lie::Motion& b) const { return b.rdot + (b.A * b.omega_bar).cross(arm); }
    /// Velocity of the contact point per impulse [1/kg]
    Mat3 inverse_mass() const
    {
        return Mat3::Identity() / m + (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose()) / J;
    }
    static double kinetic(const lie::Motion& b)
    {
        return 0.5 * (m * b.rdot.squaredNorm() + J * b.omega_bar.squaredNorm());
    }
};

}  // namespace

TEST_CASE("an impact of a contact with ideal rolling follows its law and supplies no energy (long)",
          "[contact][unilateral]")
{
    int limited = 0;
    for (const Unilateral::Impact law : {Unilateral::Impact::newton, Unilateral::Impact::poisson})
        for (const double e : {0.3, 0.8, 1.})
            for (unsigned seed = 1; seed <= 40; ++seed) {
                const Impact impact(law, e, seed);
                INFO("law " << static_cast<int>(law) << ", restitution " << e << ", seed " << seed);
                REQUIRE(impact.happened);
                const double T = Impact::kinetic(impact.before);
                CHECK(Impact::kinetic(impact.after) < T * (1 + 1e-9));

                const Vec3 v = impact.velocity(impact.before), after = impact.velocity(impact.after),
                           P = m * (impact.after.rdot - impact.before.rdot),
                           compression = -impact.inverse_mass().inverse() * v;
                CHECK(after.head<2>().norm() < 1e-9 * v.norm());
                if (law == Unilateral::Impact::poisson) {
                    CHECK(P.z() == Approx((1 + e) * compression.z()).epsilon(1e-9));
                } else if (after.z() < -e * v.z() * (1 - 1e-9)) {
                    ++limited;
                    CHECK(Impact::kinetic(impact.after) == Approx(T).epsilon(1e-9));
                } else {
                    CHECK(after.z() == Approx(-e * v.z()).epsilon(1e-9));
                }
            }
    CHECK(limited > 5);
    CHECK(limited < 60);
}
