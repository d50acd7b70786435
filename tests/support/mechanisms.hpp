// SPDX-License-Identifier: GPL-3.0-or-later
/// The driven benchmark mechanisms, written row by row: slider-crank and four-link mechanism of Fang (2022),
/// Tables 3.3 to 3.5, with 18 rows each. The numbers are those of the published code (sbel-reproducibility,
/// HalfImplicit_JCND) with the crank mass of the table.

#pragma once

#include "dae/constraints/cd.hpp"
#include "dae/constraints/d.hpp"
#include "dae/constraints/dp1.hpp"
#include "dae/constraints/dp2.hpp"
#include "dae/model.hpp"

namespace hilda::tests {

using dae::ground;
using lie::Mat3;
using lie::Vec3;

inline Mat3 matrix(const Vec3& first_row, const Vec3& second_row, const Vec3& third_row)
{
    Mat3 A;
    A << first_row.transpose(), second_row.transpose(), third_row.transpose();
    return A;
}

inline int add_body(dae::Model& model, lie::State& x, const std::string& name, double m, const Vec3& J_bar,
                    const Vec3& r, const Mat3& A, const Vec3& rdot = Vec3::Zero(),
                    const Vec3& omega_bar = Vec3::Zero())
{
    lie::Motion motion;
    motion.r = r, motion.rdot = rdot, motion.A = A, motion.omega_bar = omega_bar;
    x.body.push_back(motion);
    return model.add({.name = name, .m = m, .J_bar = J_bar.asDiagonal()});
}

/// The three bodies of the slider-crank and their consistent motion at t = 0
inline void slider_crank_bodies(dae::Model& model, lie::State& x)
{
    add_body(model, x, "crank", 0.12, {1e-4, 1e-5, 1e-4}, {0, 0.1, 0.12},
             matrix({1, 0, 0}, {0, 0, -1}, {0, 1, 0}), {0, 0, 0}, {-6.2831853071795862, 0, 0});
    add_body(model, x, "connecting rod", 0.5, {4e-3, 4e-4, 4e-3}, {0.1, 0.05, 0.1},
             matrix({0.66666666666666667, 0, 0.74535599249992989},
                    {-0.33333333333333333, 0.89442719099991588, 0.29814239699997196},
                    {-0.66666666666666667, -0.44721359549995794, 0.59628479399994392}),
             {-0.12566370614359172, 0.25132741228718345, 0},
             {-1.3404128655316495, 1.1239703569665000, -1.4986271426220260});
    add_body(model, x, "slider", 2, {1e-4, 1e-4, 1e-4}, {0.2, 0, 0}, matrix({0, 0, 1}, {0, 1, 0}, {-1, 0, 0}),
             {-0.25132741228718345, 0, 0});
}

inline void slider_crank(dae::Model& model, lie::State& x)
{
    using namespace dae;
    slider_crank_bodies(model, x);
    constexpr int crank = 0, rod = 1, slider = 2;
    const Vec3 X = Vec3::UnitX(), Y = Vec3::UnitY(), Z = Vec3::UnitZ(), O = Vec3::Zero();
    const Vec3 A(0, 0.1, 0.12), B_rod(-0.15, 0, 0), B_crank(0, 0.08, 0), C(0.15, 0, 0), guide(0.2, 0, 0);

    model.constrain("rev_A_CD_1", CD(X, ground, A, crank, O));
    model.constrain("rev_A_CD_2", CD(Y, ground, A, crank, O));
    model.constrain("rev_A_CD_3", CD(Z, ground, A, crank, O));
    model.constrain("rev_A_DP1_1", DP1(ground, Y, crank, X));
    model.constrain("rev_A_DP1_2", DP1(ground, Z, crank, X));
    model.constrain("sphere_B_CD_1", CD(X, rod, B_rod, crank, B_crank));
    model.constrain("sphere_B_CD_2", CD(Y, rod, B_rod, crank, B_crank));
    model.constrain("sphere_B_CD_3", CD(Z, rod, B_rod, crank, B_crank));
    model.constrain("rev_cyl_C_DP1_1", DP1(rod, Y, slider, Z));
    model.constrain("rev_cyl_C_DP2_1", DP2(rod, Y, C, slider, O));
    model.constrain("rev_cyl_C_DP2_2", DP2(rod, Z, C, slider, O));
    model.constrain("trans_D_DP1_1", DP1(slider, -X, ground, X));
    model.constrain("trans_D_DP1_2", DP1(slider, Y, ground, X));
    model.constrain("trans_D_DP2_1", DP2(slider, -X, O, ground, guide));
    model.constrain("trans_C_DP2_2", DP2(slider, Y, O, ground, guide));
    model.constrain("trans_D_DP1_3", DP1(slider, -X, ground, Y));
    model.constrain("trans_D", D(rod, C, slider, Z, 1.0));
    model.constrain("driver", DP1(ground, Y, crank, Y, Driver("cos(-2*pi*t + pi/2)")));
}

enum class FourLinkStart {
    consistent,  ///< projected on the constraints, 17 digits
    stored       ///< as published: link 3 is off by 2.4e-3 rad, and the driven rotor is at rest
};

inline void four_link(dae::Model& model, lie::State& x, FourLinkStart start = FourLinkStart::consistent)
{
    using namespace dae;
    const Vec3 X = Vec3::UnitX(), Y = Vec3::UnitY(), Z = Vec3::UnitZ(), O = Vec3::Zero();
    const Mat3 A_rotor = matrix({0, 0, 1}, {0, 1, 0}, {-1, 0, 0});
    if (start == FourLinkStart::consistent) {
        add_body(model, x, "rotor", 2, {4, 2, 2}, O, A_rotor, O, {0, 0, 3.1415926535897931});
        add_body(model, x, "link 2", 1, {12.4, 0.1, 12.4}, {-3.745557718914304, -4.25, 4.262365437828616},
                 matrix({0.7501572123794653, 0.6140258555597219, 0.24543106042068244},
                        {-0.6612594705590589, 0.6967213114754098, 0.27805633733461},
                        {-0.0002632698674116588, -0.3708795799719043, 0.9286809289787538}),
                 {-5.266847522470136, -3.14159265358981, -2.8180737328162566},
                 {0.4977376324560374, 1.9303386981341297, -0.9881360059689986});
        add_body(model, x, "link 3", 1, {4.54, 0.01, 4.54}, {-5.745557718914304, -8.5, 3.2623654378286155},
                 matrix({0, 0.4717723564633253, 0.8817203886023283}, {-1, 0, 0},
                        {0, -0.8817203886023285, 0.4717723564633257}),
                 {-5.266847522470134, 0, -2.818073732816258}, {1.6144259810377577, 0, 0});
    } else {
        add_body(model, x, "rotor", 2, {4, 2, 2}, O, A_rotor);
        add_body(model, x, "link 2", 1, {12.4, 0.1, 12.4}, {-3.74555772, -4.25, 4.26236544},
                 matrix({0.750157212, 0.614025856, 0.24543106}, {-0.661259471, 0.696721311, 0.278056337},
                        {-0.000263269879, -0.37087958, 0.928680929}),
                 {-5.26684752, -3.14159265, -2.81807373}, {0.49773763, 1.9303387, -0.98813601});
        add_body(model, x, "link 3", 1, {4.54, 0.01, 4.54}, {-5.74555772, -8.5, 3.26236544},
                 matrix({0, 0.474123134, 0.880458547}, {-1, 0, 0}, {0, -0.880458546, 0.474123135}),
                 {-5.26684752, 0, -2.81807373}, {1.61443, 0, 0});
    }
    constexpr int rotor = 0, link_2 = 1, link_3 = 2;
    const Vec3 D(-4, -8.5, 0), D_3(0, 3.7, 0), C_3(0, -3.7, 0), C_2(0, -6.1, 0), B_1(-2, 0, 0),
        B_2(0, 6.1, 0);

    model.constrain("revA-dp1-ki", DP1(rotor, X, ground, X));
    model.constrain("revA-dp1-ji", DP1(rotor, Y, ground, X));
    model.constrain("revA-CD-i", CD(X, rotor, O, ground, O));
    model.constrain("revA-CD-j", CD(Y, rotor, O, ground, O));
    model.constrain("revA-CD-k", CD(Z, rotor, O, ground, O));
    model.constrain("revD-dp1-ii", DP1(link_3, Z, ground, Y));
    model.constrain("revD-dp1-ij", DP1(link_3, Y, ground, Y));
    model.constrain("revD-CD-i", CD(X, link_3, D_3, ground, D));
    model.constrain("revD-CD-j", CD(Y, link_3, D_3, ground, D));
    model.constrain("revD-CD-k", CD(Z, link_3, D_3, ground, D));
    model.constrain("spherical-CD-i", CD(X, link_3, C_3, link_2, C_2));
    model.constrain("spherical-CD-j", CD(Y, link_3, C_3, link_2, C_2));
    model.constrain("spherical-CD-k", CD(Z, link_3, C_3, link_2, C_2));
    model.constrain("univ-CD-i", CD(X, rotor, B_1, link_2, B_2));
    model.constrain("univ-CD-j", CD(Y, rotor, B_1, link_2, B_2));
    model.constrain("univ-CD-k", CD(Z, rotor, B_1, link_2, B_2));
    model.constrain("univ-DP1", DP1(rotor, {0, -0.662, 0.75}, link_2, Z));
    model.constrain("driving-kk", DP1(rotor, -X, ground, Y, Driver("cos(pi*t + pi/2)")));
}

}  // namespace hilda::tests
