// SPDX-License-Identifier: GPL-3.0-or-later
/// A tree of bodies with random poses, inertias and joints of all kinds that a tree may have.
#pragma once

#include "dae/forces/spring_damper.hpp"
#include "dae/joints.hpp"
#include "dae/model.hpp"
#include "dae/start.hpp"
#include "tests/support/random_motion.hpp"

#include <string>

namespace hilda::tests {

/// Bodies with a joint to the ground or to a body before them, by turns revolute, spherical, translational
/// and fixed; every seventh body is free. Body numbers and the order of i and j do not follow the tree.
/// Springs with dampers connect bodies that have no joint. `x` is a consistent start in motion.
inline void random_tree(int bodies, unsigned seed, dae::Model& model, lie::State& x)
{
    Random random(seed);
    for (int b = 0; b < bodies; ++b) {
        const lie::Mat3 R = random.rotation();
        const lie::Vec3 sides = random.vector().cwiseAbs() + lie::Vec3::Constant(0.3);
        const lie::Vec3 squares = sides.cwiseProduct(sides);
        const double m = random.number(0.5, 1.5);
        const lie::Vec3 J(squares.y() + squares.z(), squares.z() + squares.x(), squares.x() + squares.y());
        model.add({.name = "body " + std::to_string(b),
                   .m = m,
                   .J_bar = R * (m / 12 * J).asDiagonal() * R.transpose()});
        lie::Motion& body = x.body.emplace_back();
        body.r = random.vector(2), body.A = random.rotation();
        body.rdot = random.vector(), body.omega_bar = random.vector();
    }
    // Body n of the tree is body (5 n + 2) mod N of the model; 5 must not divide N.
    const auto of_tree = [&](int n) { return n < 0 ? dae::ground : (5 * n + 2) % bodies; };
    for (int n = 0; n < bodies; ++n) {
        if (n % 7 == 6) continue;
        int i = of_tree(n < 2 ? -1 : static_cast<int>(random.number(0, n))), j = of_tree(n);
        if (n % 3 == 1) std::swap(i, j);
        const lie::Motion &bi = dae::motion(x, i), &bj = dae::motion(x, j);
        const lie::Vec3 p = random.vector(), a = random.unit();
        const lie::Vec3 q = n % 4 == 2 ? lie::Vec3(p + random.number() * a) : p;
        const lie::Vec3 s_i = bi.A.transpose() * (p - bi.r), s_j = bj.A.transpose() * (q - bj.r);
        const lie::Vec3 a_i = bi.A.transpose() * a, a_j = (n % 8 == 0 ? 1 : -1) * bj.A.transpose() * a;
        const std::string name = "joint " + std::to_string(n);
        if (n % 4 == 0) model.constrain(name, dae::revolute(i, s_i, a_i, j, s_j, a_j));
        if (n % 4 == 1) model.constrain(name, dae::spherical(i, s_i, j, s_j));
        if (n % 4 == 2) model.constrain(name, dae::translational(i, s_i, a_i, j, s_j, a_j, x));
        if (n % 4 == 3) model.constrain(name, dae::fixed(i, j, x));
    }
    for (int b = 0; b + 3 < bodies; b += 2)
        model.load(dae::SpringDamper(b, random.vector(0.1), b + 3, random.vector(0.1), 20, 1, 0.3));
    dae::start(model, x, {.fix_initial = true});
}

}  // namespace hilda::tests
