// SPDX-License-Identifier: GPL-3.0-or-later
/// Random input for tests from a seed: numbers, vectors, rotations, motions; and displaced poses of a motion.

#pragma once

#include "lie/state.hpp"

#include <random>

namespace hilda::tests {

/// A random number generator. The same seed gives the same input.
class Random {
public:
    explicit Random(unsigned seed) : engine(seed) {}

    double number(double low = -1, double high = 1)
    {
        return std::uniform_real_distribution<>(low, high)(engine);
    }
    /// Uniformly distributed in the cube |x|, |y|, |z| < size
    lie::Vec3 vector(double size = 1)
    {
        const double x = number(-size, size), y = number(-size, size), z = number(-size, size);
        return {x, y, z};
    }
    lie::Vec3 unit() { return direction(3).head<3>(); }
    /// Uniformly distributed on SO(3): the Euler parameters are a random direction in R⁴
    lie::Mat3 rotation()
    {
        const Eigen::Vector4d p = direction(4);
        return Eigen::Quaterniond(p[0], p[1], p[2], p[3]).toRotationMatrix();
    }
    lie::Motion motion()
    {
        lie::Motion m;
        m.r = vector(), m.rdot = vector(2), m.rddot = vector(3);
        m.A = rotation(), m.omega_bar = vector(2), m.omegadot_bar = vector(3);
        return m;
    }
    lie::State state(int bodies)
    {
        lie::State x;
        x.t = number(0, 1);
        for (int b = 0; b < bodies; ++b) x.body.push_back(motion());
        return x;
    }

private:
    Eigen::Vector4d direction(int n)
    {
        Eigen::Vector4d v = Eigen::Vector4d::Zero();
        std::normal_distribution<> normal;
        for (int k = 0; k < n; ++k) v[k] = normal(engine);
        return v.normalized();
    }

    std::mt19937 engine;
};

/// The pose r + ṙ τ + r̈ τ²/2, A exp(ω̄ τ + ω̄̇ τ²/2) at the time τ: a curve with the velocities and
/// accelerations of the motion m at τ = 0.
inline lie::Motion pose_after(const lie::Motion& m, double tau)
{
    lie::Motion at = m;
    at.r += tau * m.rdot + 0.5 * tau * tau * m.rddot;
    at.A = m.A * lie::exp(tau * m.omega_bar + 0.5 * tau * tau * m.omegadot_bar);
    return at;
}

/// The pose r + δr, A exp(δπ̄) with δ = (δr, δπ̄)
inline lie::Motion displaced(const lie::Motion& m, const Eigen::Matrix<double, 6, 1>& delta)
{
    lie::Motion at = m;
    at.r += delta.head<3>();
    at.A = m.A * lie::exp(delta.tail<3>());
    return at;
}

}  // namespace hilda::tests
