// SPDX-License-Identifier: GPL-3.0-or-later
/// Energy, and the default variations of a system by central differences.
#include "lie/system.hpp"

#include "lie/tree/tree.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::lie {

const Tree& System::tree() const
{
    static const Tree none{.joint = {}, .refusal = "the system does not describe its joints"};
    return none;
}

double energy(const System& system, const State& x)
{
    double e = system.potential_energy(x);
    for (int b = 0; b < system.bodies(); ++b) {
        const Motion& body = x.body[b];
        e += 0.5 * system.mass().m[b] * body.rdot.squaredNorm() +
             0.5 * body.omega_bar.dot(system.mass().J_bar[b] * body.omega_bar);
    }
    return e;
}

System::PositionError System::position_error(const State& x) const
{
    PositionError largest;
    Eigen::VectorXd Phi(rows());
    phi(x, Phi);
    for (int k = 0; k < rows(); ++k)
        if (largest.row < 0 || std::abs(Phi[k]) > largest.value || std::isnan(Phi[k]))
            largest = {.value = std::abs(Phi[k]), .row = k};
    return largest;
}

namespace {

// Increment of the central differences. For quantities of order one, the truncation error h² and the rounding
// error 1e-16/h are about equal at 6e-6.
constexpr double h = 6e-6;

/// Changes component c (0 to 11) of (r, A, ṙ, ω̄) by the amount `by`; a rotation is A ← A exp(by ẽ_c).
void displace(Motion& body, int c, double by)
{
    if (c < 3)
        body.r[c] += by;
    else if (c < 6)
        body.A = body.A * exp(by * Vec3::Unit(c - 3));
    else if (c < 9)
        body.rdot[c - 6] += by;
    else
        body.omega_bar[c - 9] += by;
}

/// Calls use(body, component, state displaced by +h, state displaced by -h) for the first `components`
/// components of each body; see displace().
template <class Use>
void for_each_difference(const State& x, int components, Use use)
{
    State plus = x, minus = x;
    for (size_t b = 0; b < x.body.size(); ++b)
        for (int c = 0; c < components; ++c) {
            displace(plus.body[b], c, h);
            displace(minus.body[b], c, -h);
            use(static_cast<int>(b), c, plus, minus);
            plus.body[b] = minus.body[b] = x.body[b];
        }
}

}  // namespace

void System::second_variation(const State& x, SecondVariation& out) const
{
    Rows plus = pattern(), minus = pattern();
    for_each_difference(x, 6, [&](int body, int c, const State& x_plus, const State& x_minus) {
        variation(x_plus, plus);
        variation(x_minus, minus);
        for (int k = 0; k < plus.rows(); ++k)
            for (int b = 0; b < out.entries[k]; ++b) {
                if (plus.entry[plus.start[k] + b].body != body) continue;
                for (int a = 0; a < out.entries[k]; ++a) {
                    const Rows::Entry &p = plus.entry[plus.start[k] + a], &m = minus.entry[plus.start[k] + a];
                    out.at(k, a, b).col(c) << (p.r - m.r) / (2 * h), (p.pi - m.pi) / (2 * h);
                }
            }
    });
}

void System::nu_variation(const State& x, Rows& out) const
{
    Eigen::VectorXd plus(rows()), minus(rows());
    for_each_difference(x, 6, [&](int body, int c, const State& x_plus, const State& x_minus) {
        nu(x_plus, plus);
        nu(x_minus, minus);
        for (int k = 0; k < out.rows(); ++k)
            for (int n = out.start[k]; n < out.start[k + 1]; ++n)
                if (out.entry[n].body == body)
                    (c < 3 ? out.entry[n].r : out.entry[n].pi)[c % 3] = (plus[k] - minus[k]) / (2 * h);
    });
}

void System::gamma_variation(const State& x, GammaVariation& out) const
{
    Eigen::VectorXd plus(rows()), minus(rows());
    const Rows& C = pattern();
    for_each_difference(x, 12, [&](int body, int c, const State& x_plus, const State& x_minus) {
        gamma(x_plus, plus);
        gamma(x_minus, minus);
        for (int k = 0; k < C.rows(); ++k)
            for (int n = C.start[k]; n < C.start[k + 1]; ++n) {
                if (C.entry[n].body != body) continue;
                GammaVariation::Entry& e = out.entry[n];
                Vec3* const part[] = {&e.r, &e.theta, &e.rdot, &e.omega};
                (*part[c / 3])[c % 3] = (plus[k] - minus[k]) / (2 * h);
            }
    });
}

}  // namespace hilda::lie
