// SPDX-License-Identifier: GPL-3.0-or-later
/// Variations by central differences, for systems that do not give theirs in closed form.
#include "lie/system.hpp"

namespace hilda::lie {

namespace {

// Truncation h² and rounding 1e-16/h balance here for quantities of size one.
constexpr double h = 6e-6;

/// Moves component c of (δr, δθ, δṙ, δω̄)
void move(Motion& body, int c, double by)
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

/// Calls back for each component of each body with the states on both sides of x.
template <class Use>
void differences(const State& x, int components, Use use)
{
    State plus = x, minus = x;
    for (size_t b = 0; b < x.body.size(); ++b)
        for (int c = 0; c < components; ++c) {
            move(plus.body[b], c, h);
            move(minus.body[b], c, -h);
            use(static_cast<int>(b), c, plus, minus);
            plus.body[b] = minus.body[b] = x.body[b];
        }
}

}  // namespace

void System::second_variation(const State& x, SecondVariation& out) const
{
    Rows plus = pattern(), minus = pattern();
    differences(x, 6, [&](int body, int c, const State& ahead, const State& behind) {
        variation(ahead, plus);
        variation(behind, minus);
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
    differences(x, 6, [&](int body, int c, const State& ahead, const State& behind) {
        nu(ahead, plus);
        nu(behind, minus);
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
    differences(x, 12, [&](int body, int c, const State& ahead, const State& behind) {
        gamma(ahead, plus);
        gamma(behind, minus);
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
