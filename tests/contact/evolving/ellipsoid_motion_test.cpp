// SPDX-License-Identifier: GPL-3.0-or-later
/// Motions of ellipsoids with evolving contacts: against closed forms, against an independent integration of
/// the same motions in minimal coordinates, and conservation of momentum.

#include "dae/model.hpp"
#include "tests/support/evolving.hpp"

#include <catch2/catch.hpp>

#include <numbers>

using namespace hilda;
using namespace hilda::contact;
using namespace hilda::tests;

namespace {

using std::numbers::pi;

const Vec3 egg(0.3, 0.25, 0.15);

/// An ellipsoid of 2 kg on the plane z = 0, with the orientation, velocity and angular velocity given
struct EllipsoidOnPlane : ContactModel {
    EllipsoidOnPlane(const Mat3& A, const Vec3& rdot, const Vec3& omega_bar, Friction friction)
    {
        Motion body;
        body.A = A;
        const Vec3 lowest = -*Ellipsoid(egg).support(A.transpose() * Vec3::UnitZ());
        body.r.z() = -(A * lowest).z();
        body.rdot = rdot, body.omega_bar = omega_bar;
        add("egg", 2, inertia(2, egg), body);
        add_contact("floor", 0, shape<Ellipsoid>(egg), dae::ground, shape<Plane>(), friction);
        start(true);
    }
};

Mat3 rotation(double e0, double e1, double e2, double e3)
{
    return Eigen::Quaterniond(e0, e1, e2, e3).normalized().toRotationMatrix();
}

}  // namespace

TEST_CASE("an ellipsoid rocks on a plane with the period of the closed form", "[contact][evolving][order]")
{
    const double b = egg.y(), c = egg.z(), m = 2, g = 9.81, J = m * (b * b + c * c) / 5;
    for (const Friction friction : {Friction::none, Friction::rolling}) {
        const bool rolls = friction == Friction::rolling;
        const auto angle_after_quarter = [&](double theta_0, double period, long steps) {
            EllipsoidOnPlane scene(lie::exp(theta_0 * Vec3::UnitX()), Vec3::Zero(), Vec3::Zero(), friction);
            const lie::State x =
                run(scene, "rA-half-1-momentum", period / 4 / double(steps), period / 4 * (1 - 1e-9));
            return lie::log(x.body[0].A).x();
        };
        const double period = rolls ? 1.0671467671 : 0.7120300728;
        const auto steps = std::lround(period / 4 / 4e-3);
        const double coarse = angle_after_quarter(0.6, period, steps),
                     fine = angle_after_quarter(0.6, period, 2 * steps);
        INFO((rolls ? "rolling" : "frictionless") << ": angle " << coarse << ", " << fine << " rad");
        CHECK(std::abs(coarse) < 2e-3);
        CHECK(std::log2(coarse / fine) == Approx(2).margin(0.03));

        const double small = 2 * pi * std::sqrt((rolls ? J + m * c * c : J) / (m * g * (b * b / c - c)));
        // extrapolated from two step sizes; the period depends on the square of the amplitude
        const double at_h = angle_after_quarter(1e-4, small, 100),
                     at_half = angle_after_quarter(1e-4, small, 200);
        CHECK(std::abs((4 * at_half - at_h) / 3) < 1e-7 * 1e-4);
    }
}

TEST_CASE("the spatial motion of an ellipsoid on a plane has second order (long)",
          "[contact][evolving][order]")
{
    // an independent integration of the same motions in minimal coordinates
    struct Node {
        double t;
        Vec3 r;
        Eigen::Vector4d p;  // Euler parameters
        Vec3 alpha;
        double F_N;
    };
    const std::vector<Node> slides{
        {0.5,
         {0.15, 0, 0.17276422870620975},
         {0.4046484432465963, -0.1651869205696614, -0.11541264749639178, 0.8919937440636522},
         {0.1048593648422882, 0.12284805069120393, -0.11965841683772886},
         14.869793302331693},
        {1,
         {0.3, 0, 0.18204868708218258},
         {-0.5541088497626463, -0.06984901993510965, -0.20899673615202657, 0.8027483175358402},
         {0.1699438917756906, 0.0886217722109719, -0.11159029415007501},
         12.275310149435677}};
    const std::vector<Node> rolls{
        {0.5,
         {-0.17482522660043978, 0.10053258146586448, 0.18247483684862564},
         {0.889132185275466, -0.19614591972013753, -0.17137017529627613, 0.3763017383740599},
         {-0.0774951991397586, 0.16364348451319585, -0.10657445809887509},
         16.672473283536068},
        {1,
         {0.028062074294899295, 0.09476423513920985, 0.17604451859495365},
         {0.6838789470201794, 0.19080718908601665, 0.13672077276904582, 0.6908036137058774},
         {-0.03917060768187866, -0.15971544104923222, -0.11372408678032903},
         17.872169994759652}};
    const Mat3 A = rotation(0.9565680814220291, 0.2463700839976002, 0.1478220503985601, 0.04927401679952004);
    struct Errors {
        double r = 0, A = 0, alpha = 0, F_N = 0, p_x = 0, L_z = 0;
    };
    const auto errors = [&](Friction friction, double h) {
        const bool rolling = friction == Friction::rolling;
        EllipsoidOnPlane scene(A,
                               rolling ? Vec3(0.007784747560074652, -0.251584493887696, 0.10070796386032964)
                                       : Vec3(0.3, 0, 0.16523035228314287),
                               rolling ? Vec3(0.5, 1, 1) : Vec3(1, 2, 4), friction);
        Errors worst;
        double L_z = 0;
        run(scene, "rA-half-1-momentum", h, 1, [&](const lie::State& x, long n) {
            const Motion& body = x.body[0];
            const double L = (body.A * (scene.model.mass().J_bar[0] * body.omega_bar)).z();
            if (n == 0) L_z = L;
            worst.L_z = std::max(worst.L_z, std::abs(L - L_z));
            worst.p_x = std::max(worst.p_x, std::abs(body.rdot.x() - 0.3));
            for (const Node& node : rolling ? rolls : slides) {
                if (std::abs(node.t - x.t) > 0.1 * h) continue;
                const Mat3 A_exact = rotation(node.p[0], node.p[1], node.p[2], node.p[3]);
                worst.r = std::max(worst.r, (body.r - node.r).norm());
                worst.A = std::max(worst.A, (body.A - A_exact).cwiseAbs().maxCoeff());
                worst.alpha = std::max(worst.alpha, (x.alpha.head<3>() - node.alpha).norm());
                worst.F_N = std::max(worst.F_N, std::abs(multipliers(scene.model, x).F_N - node.F_N));
            }
        });
        return worst;
    };
    for (const Friction friction : {Friction::none, Friction::rolling}) {
        const Errors coarse = errors(friction, 2.5e-3), fine = errors(friction, 1.25e-3);
        INFO((friction == Friction::rolling ? "rolls" : "slides")
             << ": r " << coarse.r << ", " << fine.r << "; A " << coarse.A << ", " << fine.A << "; alpha "
             << coarse.alpha << ", " << fine.alpha << "; F_N " << coarse.F_N << ", " << fine.F_N << "; p_x "
             << coarse.p_x << "; L_z " << coarse.L_z);
        CHECK(std::log2(coarse.r / fine.r) == Approx(2).margin(0.05));
        CHECK(std::log2(coarse.A / fine.A) == Approx(2).margin(0.05));
        CHECK(std::log2(coarse.alpha / fine.alpha) == Approx(2).margin(0.05));
        CHECK(std::log2(coarse.F_N / fine.F_N) == Approx(2).margin(0.05));
        CHECK(coarse.r < 2e-5);
        CHECK(coarse.A < 3.5e-4);
        CHECK(coarse.alpha < 1.3e-4);
        CHECK(coarse.F_N < 1.9e-2);
        if (friction == Friction::rolling) continue;
        CHECK(coarse.p_x < 1e-13);
        CHECK(coarse.L_z < 1e-12);
    }
}

TEST_CASE("a rattleback reverses its spin in one direction only (long)", "[contact][evolving][order]")
{
    // its principal axes of inertia are rotated by 0.1 rad against those of its shape
    const Vec3 axes(0.2, 0.05, 0.04);
    const Mat3 turn = lie::exp(Vec3(0, 0, 0.1));
    struct RattlebackRun {
        Vec3 r;
        double spin;
    };
    const auto rattle = [&](double spin, double h, double t_end) {
        ContactModel scene;
        Motion body;
        body.A = rotation(0.9999843750406902, 0.002499986979187012, 0.004999973958374024, 0);
        body.r = Vec3(0, 0, 0.04004825013736783);
        body.omega_bar = Vec3(0, 0, spin);
        const Vec3 contact(0.009987743917568315, -0.00031211699742400985, -0.03994931103241496);
        body.rdot = -body.A * body.omega_bar.cross(contact);
        scene.add("stone", 1, turn * inertia(1, axes) * turn.transpose(), body);
        scene.add_contact("table", 0, shape<Ellipsoid>(axes), dae::ground, shape<Plane>(), Friction::rolling);
        scene.start(true);
        const lie::State x = run(scene, "rA-half-1-momentum", h, t_end);
        return RattlebackRun{x.body[0].r, x.body[0].omega_bar.z()};
    };
    const RattlebackRun reverses = rattle(-3, 2e-3, 4), keeps_spinning = rattle(3, 2e-3, 4);
    CHECK(reverses.spin > 2.5);
    CHECK(keeps_spinning.spin > 2.5);
    // an independent integration of the same motion in minimal coordinates
    const Vec3 at_2(-0.0023701663988757644, 0.002404538686150646, 0.04121026737393959);
    const double coarse = (rattle(-3, 1e-3, 2).r - at_2).norm(), fine = (rattle(-3, 5e-4, 2).r - at_2).norm();
    INFO("centre off by " << coarse << ", " << fine);
    CHECK(coarse < 7.8e-6);
    CHECK(std::log2(coarse / fine) == Approx(2).margin(0.05));
}

TEST_CASE("two free ellipsoids in contact conserve momentum and angular momentum (long)",
          "[contact][evolving][order]")
{
    struct Drift {
        double P = 0, L = 0, energy = 0;
    };
    const auto drift = [](const char* scheme, double h) {
        ContactModel scene;
        scene.model.gravity.setZero();
        const Vec3 axes_i(0.3, 0.25, 0.2), axes_j(0.4, 0.3, 0.25);
        Motion i, j;
        j.A = lie::exp(Vec3(0.3, -0.2, 0.5));
        const Ellipsoid surface_i(axes_i), surface_j(axes_j);
        tests::place_in_contact(shape<Ellipsoid>(axes_i), *surface_i.support(Vec3(1, 2, 2).normalized()), i,
                                shape<Ellipsoid>(axes_j), *surface_j.support(Vec3(1, -1, 1).normalized()), j,
                                0.4);
        i.omega_bar = Vec3(0.8, -0.5, 1.0), j.omega_bar = Vec3(-0.4, 0.9, 0.3);
        i.rdot = Vec3(0.2, 0.1, -0.1);
        scene.add("i", 1, inertia(1, axes_i), i);
        scene.add("j", 1.5, inertia(1.5, axes_j), j);
        scene.add_contact("contact", 0, shape<Ellipsoid>(axes_i), 1, shape<Ellipsoid>(axes_j));
        scene.start(true);
        Drift worst;
        Vec3 P_0, L_0;
        double energy_0 = 0;
        run(scene, scheme, h, 1, [&](const lie::State& x, long n) {
            Vec3 P = Vec3::Zero(), L = Vec3::Zero();
            for (int b = 0; b < 2; ++b) {
                const Motion& body = x.body[b];
                P += scene.model.mass().m[b] * body.rdot;
                L += scene.model.mass().m[b] * body.r.cross(body.rdot) +
                     body.A * (scene.model.mass().J_bar[b] * body.omega_bar);
            }
            const double energy = lie::energy(scene.model, x);
            if (n == 0) P_0 = P, L_0 = L, energy_0 = energy;
            worst.P = std::max(worst.P, (P - P_0).norm());
            worst.L = std::max(worst.L, (L - L_0).norm());
            worst.energy = std::max(worst.energy, std::abs(energy - energy_0));
        });
        return worst;
    };
    const Drift coarse = drift("rA-half-1-momentum", 2e-3), fine = drift("rA-half-1-momentum", 1e-3);
    INFO("P " << coarse.P << ", L " << coarse.L << ", energy " << coarse.energy << ", " << fine.energy);
    CHECK(coarse.P < 2e-15);
    CHECK(coarse.L < 1e-14);
    CHECK(std::log2(coarse.energy / fine.energy) == Approx(2).margin(0.05));
    const double text = drift("rA-half-1", 2e-3).energy, text_half = drift("rA-half-1", 1e-3).energy;
    INFO("energy with rA-half-1 " << text << ", " << text_half);
    CHECK(std::log2(text / text_half) == Approx(1).margin(0.1));
}
