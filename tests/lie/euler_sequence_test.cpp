// SPDX-License-Identifier: GPL-3.0-or-later
/// Euler angles of all sequences.
#include <catch2/catch.hpp>

#include "lie/euler_angles.hpp"
#include "lie/euler_sequence.hpp"
#include "tests/support/random_motion.hpp"

#include <numbers>

using namespace hilda;
using lie::EulerSequence;
using lie::Mat3;
using lie::Vec3;

namespace {

using std::numbers::pi;

std::vector<std::string> sequences()
{
    std::vector<std::string> all;
    for (const char a : {'x', 'y', 'z'})
        for (const char b : {'x', 'y', 'z'})
            for (const char c : {'x', 'y', 'z'})
                if (a != b && b != c) all.push_back({a, b, c});
    return all;
}

}  // namespace

TEST_CASE("the angles of each of the twelve sequences give the rotation", "[lie][euler]")
{
    REQUIRE(sequences().size() == 12);
    tests::Random random(4);
    for (const std::string& name : sequences()) {
        const EulerSequence s = EulerSequence::named(name).value();
        INFO(name);
        for (int k = 0; k < 50; ++k) {
            const Mat3 A = random.rotation();
            const Vec3 angles = s.angles(A);
            CHECK((s.rotation(angles) - A).norm() < 1e-14);
            CHECK(angles.cwiseAbs().maxCoeff() <= pi);
            if (s.is_proper())
                CHECK(angles[1] >= 0);
            else
                CHECK(std::abs(angles[1]) <= pi / 2);
        }
        const Vec3 given(0.3, s.is_proper() ? 1.2 : -0.7, -2.1);
        CHECK((s.angles(s.rotation(given)) - given).norm() < 1e-14);
    }
}

TEST_CASE("at the singular orientations of each sequence the third angle is zero", "[lie][euler]")
{
    for (const std::string& name : sequences()) {
        const EulerSequence s = EulerSequence::named(name).value();
        INFO(name);
        for (const double second : {s.is_proper() ? 0. : pi / 2, s.is_proper() ? pi : -pi / 2}) {
            // the exact rotation, without the rounding errors of sines and cosines
            const Mat3 A = s.rotation({0, second, 0}).array().round();
            const Vec3 angles = s.angles(A);
            CHECK(angles[2] == 0);
            CHECK(angles[1] == Approx(second));
            CHECK((s.rotation(angles) - A).norm() < 1e-15);
            const Mat3 near = s.rotation({0.4, second, 0.7});
            CHECK((s.rotation(s.angles(near)) - near).norm() < 1e-14);
        }
    }
}

TEST_CASE("the sequence zxz is that of the dissertation, and zyx is yaw, pitch and roll", "[lie][euler]")
{
    tests::Random random(5);
    const EulerSequence zxz = EulerSequence::named("zxz").value(), zyx = EulerSequence::named("zyx").value();
    for (int k = 0; k < 20; ++k) {
        const Mat3 A = random.rotation();
        CHECK(zxz.angles(A) == lie::euler_angles(A));
    }
    const Vec3 eps(0.3, 0.4, 0.5);
    CHECK((zxz.rotation(eps) - lie::rotation(eps)).norm() < 1e-15);
    // a body that yaws by 90 degrees and then pitches down points to -z
    CHECK((zyx.rotation({pi / 2, pi / 2, 0}) * Vec3::UnitX() + Vec3::UnitZ()).norm() < 1e-15);
    CHECK((zyx.rotation({pi / 2, 0, 0}) * Vec3::UnitX() - Vec3::UnitY()).norm() < 1e-15);
}

TEST_CASE("names that are no sequence are refused", "[lie][euler]")
{
    for (const char* name : {"", "zx", "zxzz", "zzx", "xyy", "ZXZ", "abc", "z z"})
        CHECK_FALSE(EulerSequence::named(name));
}
