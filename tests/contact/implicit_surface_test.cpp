// SPDX-License-Identifier: GPL-3.0-or-later
/// Dual against finite differences; a user-defined implicit surface against the built-in ellipsoid.

#include "contact/implicit_surface.hpp"
#include "contact/surfaces/ellipsoid.hpp"
#include "lie/check.hpp"
#include "tests/support/finite_difference.hpp"
#include "tests/support/random_motion.hpp"

#include <catch2/catch.hpp>

using namespace hilda;
using namespace hilda::contact;
using tests::derivative;
using tests::Random;

namespace {

struct Function {
    std::string name;
    Dual (*dual)(const Dual&);
    double (*real)(double);
};

#define BOTH(f)                                                                           \
    {                                                                                     \
#f, [](const Dual& x) -> Dual { return f; }, [](double x) -> double { return f; } \
    }

/// All functions of one variable, on an interval where they are smooth. Add new functions here.
const Function functions[] = {
    BOTH(sin(x)),
    BOTH(cos(x)),
    BOTH(tan(x)),
    BOTH(sinh(x)),
    BOTH(cosh(x)),
    BOTH(tanh(x)),
    BOTH(atan(x)),
    BOTH(exp(x)),
    BOTH(log(x)),
    BOTH(sqrt(x)),
    BOTH(pow(x, 2.5)),
    BOTH(pow(x, 1.0)),
    BOTH(pow(x, -2)),
    BOTH(1.0 / x),
    BOTH(x / 3.0),
    BOTH(abs(0.1 - x)),
    BOTH(-x),
    BOTH(+x),
    BOTH(2.0 - x),
    BOTH(x - 2.0),
    BOTH(x* x* x),
    BOTH(2.0 * x),
    BOTH(x * 2.0),
    BOTH(x + 1.0),
    BOTH(x / (1.0 + x * x)),
    BOTH(atan2(x, 1 + x)),
    BOTH(atan2(1 + x, -x)),
};

#undef BOTH

/// A function whose first and second derivatives are not zero
Dual inner(const Vec3& a)
{
    const Dual x = Dual::variable(a.x(), 0), y = Dual::variable(a.y(), 1), z = Dual::variable(a.z(), 2);
    return 0.7 + 0.3 * x * y - 0.2 * z * x + 0.1 * y + 0.1 * z * z;
}

double inner_value(const Vec3& a)
{
    return 0.7 + 0.3 * a.x() * a.y() - 0.2 * a.z() * a.x() + 0.1 * a.y() + 0.1 * a.z() * a.z();
}

}  // namespace

TEST_CASE("all functions of a Dual have the derivatives of the real function", "[contact][dual]")
{
    Random random(GENERATE(range(0u, 10u)));
    const Vec3 a = random.vector(0.5);
    for (const Function& f : functions) {
        INFO(f.name);
        const auto value = [&](const Vec3& x) { return f.real(inner_value(x)); };
        const Dual d = f.dual(inner(a));
        CHECK(d.f == Approx(value(a)).epsilon(1e-15));
        const Mat3 H = d.hessian();
        for (int k = 0; k < 3; ++k) {
            CHECK(d.g[k] ==
                  Approx(derivative([&](double t) { return value(a + t * Vec3::Unit(k)); })).margin(1e-10));
            const Vec3 column =
                derivative([&](double t) { return Vec3(f.dual(inner(a + t * Vec3::Unit(k))).g); });
            CHECK((H.col(k) - column).norm() < 1e-9 * (1 + H.norm()));
        }
    }
}

TEST_CASE("Duals are compared by value", "[contact][dual]")
{
    const Dual x = Dual::variable(1, 0), y = Dual::variable(2, 1);
    CHECK((x < y && x <= y && y > x && y >= x && x < 1.5 && !(x > y)));
    Dual z = x;
    z += y, z *= 3.0, z /= y, z -= 1;
    CHECK(z.f == 3.5);
    CHECK(z.g == Vec3(1.5, 1.5 - 2.25, 0));
}

TEST_CASE("a user-defined implicit ellipsoid equals the built-in ellipsoid", "[contact][surface]")
{
    Random random(GENERATE(range(0u, 10u)));
    const Vec3 D(0.9, 0.7, 1.2);
    const double L = std::cbrt(D.prod());
    const ImplicitSurface user(
        [&](auto x, auto y, auto z) {
            return 0.5 * L * (x * x / (D[0] * D[0]) + y * y / (D[1] * D[1]) + z * z / (D[2] * D[2]) - 1.0);
        },
        L);
    const Ellipsoid own(D);
    const Vec3 a = random.vector(1.5);
    constexpr double round_off = 1e-14;
    CHECK(user.value(a) == Approx(own.value(a)).margin(round_off));
    CHECK((user.gradient(a) - own.gradient(a)).norm() < round_off);
    CHECK((user.hessian(a) - own.hessian(a)).norm() < round_off);
    CHECK((user.normal(a) - own.normal(a)).norm() < round_off);
    CHECK((user.shape_operator(a) - own.shape_operator(a)).norm() <
          5 * round_off * (1 + own.shape_operator(a).norm()));
    const Vec3 outside = 2 * random.unit();
    CHECK((user.project(outside) - own.project(outside)).norm() < round_off);
}
