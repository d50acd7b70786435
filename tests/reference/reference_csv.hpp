// SPDX-License-Identifier: GPL-3.0-or-later
/// Reference trajectories in tests/data, and the deviation of a run from a trajectory.

#pragma once

#include "dae/model.hpp"
#include "lie/trajectory.hpp"
#include "tests/support/paths.hpp"

#include <catch2/catch.hpp>

#include <fstream>

namespace hilda::tests {

/// Row of a reference trajectory. Columns: t; then r, A (row major), ṙ, ω̄ of each body; then r̈, ω̄̇,
/// resultant constraint force (global) and torque (body frame) of each body.
struct Reference {
    lie::State x;
    std::vector<dae::Reaction> reaction;

    explicit Reference(const std::vector<double>& row)
    {
        x.t = row[0];
        const size_t bodies = (row.size() - 1) / 30;
        for (size_t b = 0; b < bodies; ++b) {
            const double* p = &row[1 + 18 * b];
            const double* q = &row[1 + 18 * bodies + 12 * b];
            const auto vector = [](const double* v) { return lie::Vec3(v[0], v[1], v[2]); };
            lie::Motion m;
            m.r = vector(p), m.rdot = vector(p + 12), m.omega_bar = vector(p + 15);
            m.A = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(p + 3);
            m.rddot = vector(q), m.omegadot_bar = vector(q + 3);
            x.body.push_back(m);
            reaction.push_back({vector(q + 6), vector(q + 9)});
        }
    }
};

inline std::vector<Reference> references(const std::string& file)
{
    std::ifstream in(std::string(test_data) + "/" + file);
    INFO("cannot read " << file);
    REQUIRE(in);
    std::vector<Reference> all;
    std::string line, cell;
    std::getline(in, line);
    while (std::getline(in, line)) {
        std::vector<double> row;
        std::istringstream cells(line);
        while (std::getline(cells, cell, ',')) row.push_back(std::strtod(cell.c_str(), nullptr));
        all.emplace_back(row);
    }
    return all;
}

inline std::vector<double> instants(const std::vector<Reference>& reference)
{
    std::vector<double> t;
    for (const Reference& row : reference) t.push_back(row.x.t);
    return t;
}

/// Largest deviations over a run and its bodies [m, -, m/s, rad/s, m/s², rad/s²]
struct Deviation {
    double r = 0, A = 0, rdot = 0, omega_bar = 0, rddot = 0, omegadot_bar = 0;

    void add(const lie::State& x, const lie::State& y)
    {
        REQUIRE(x.t == Approx(y.t).margin(1e-14));
        REQUIRE(x.body.size() == y.body.size());
        for (size_t b = 0; b < x.body.size(); ++b) {
            const lie::Motion &a = x.body[b], &c = y.body[b];
            r = std::max(r, (a.r - c.r).norm());
            A = std::max(A, (a.A - c.A).norm());
            rdot = std::max(rdot, (a.rdot - c.rdot).norm());
            omega_bar = std::max(omega_bar, (a.omega_bar - c.omega_bar).norm());
            rddot = std::max(rddot, (a.rddot - c.rddot).norm());
            omegadot_bar = std::max(omegadot_bar, (a.omegadot_bar - c.omegadot_bar).norm());
        }
    }
    double largest() const { return std::max({r, A, rdot, omega_bar, rddot, omegadot_bar}); }
};

inline std::ostream& operator<<(std::ostream& out, const Deviation& d)
{
    return out << "r " << d.r << ", A " << d.A << ", rdot " << d.rdot << ", omega " << d.omega_bar
               << ", rddot " << d.rddot << ", omegadot " << d.omegadot_bar;
}

inline Deviation deviation(const std::vector<lie::State>& a, const std::vector<lie::State>& b)
{
    REQUIRE(a.size() == b.size());
    Deviation d;
    for (size_t k = 0; k < a.size(); ++k) d.add(a[k], b[k]);
    return d;
}

inline Deviation deviation(const std::vector<lie::State>& run, const std::vector<Reference>& reference)
{
    REQUIRE(run.size() == reference.size());
    Deviation d;
    for (size_t k = 0; k < run.size(); ++k) d.add(run[k], reference[k].x);
    return d;
}

/// Deviation of the resultant constraint loads from those of the reference, relative to the largest of the
/// run
inline double reaction_deviation(const std::vector<std::vector<dae::Reaction>>& run,
                                 const std::vector<Reference>& reference)
{
    REQUIRE(run.size() == reference.size());
    double F = 0, T = 0, largest_F = 0, largest_T = 0;
    for (size_t k = 0; k < run.size(); ++k)
        for (size_t b = 0; b < run[k].size(); ++b) {
            const dae::Reaction& exact = reference[k].reaction[b];
            F = std::max(F, (run[k][b].F - exact.F).norm());
            T = std::max(T, (run[k][b].T - exact.T).norm());
            largest_F = std::max(largest_F, exact.F.norm());
            largest_T = std::max(largest_T, exact.T.norm());
        }
    return std::max(F / largest_F, T / largest_T);
}

}  // namespace hilda::tests
