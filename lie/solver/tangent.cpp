// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/solver/tangent.hpp"

#include "lie/system.hpp"

#include <amd.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

namespace hilda::lie {

namespace {

/// The bodies in an order of minimum degree. Two bodies are adjacent if they have a block.
std::vector<int> order_of_bodies(const Tangent& tangent)
{
    const int bodies = tangent.system.bodies();
    std::vector<std::vector<int>> adjacent(static_cast<size_t>(bodies));
    for (const Tangent::Block& b : tangent.block)
        if (b.on != b.by) adjacent[static_cast<size_t>(b.by)].push_back(b.on);
    std::vector<int> start{0}, index, order(static_cast<size_t>(bodies));
    for (std::vector<int>& column : adjacent) {
        std::sort(column.begin(), column.end());
        index.insert(index.end(), column.begin(), column.end());
        start.push_back(static_cast<int>(index.size()));
    }
    std::iota(order.begin(), order.end(), 0);
    if (index.empty()) return order;  // amd_order() refuses a null pointer
    amd_order(bodies, start.data(), index.data(), order.data(), nullptr, nullptr);
    return order;
}

/// The order of the unknowns; see TangentMatrix
std::vector<int> order_of_unknowns(const Tangent& tangent)
{
    const Rows& C = tangent.C;
    const std::vector<int> bodies = order_of_bodies(tangent);
    std::vector<int> place(bodies.size());
    for (size_t n = 0; n < bodies.size(); ++n) place[static_cast<size_t>(bodies[n])] = static_cast<int>(n);
    std::vector<std::vector<int>> rows_after(bodies.size());
    std::vector<int> order;
    const int first_row = 6 * static_cast<int>(bodies.size());
    for (int k = 0; k < C.rows(); ++k) {
        int last = -1;
        for (int n = C.start[k]; n < C.start[k + 1]; ++n) last = std::max(last, place[C.entry[n].body]);
        if (last < 0)
            order.push_back(first_row + k);
        else
            rows_after[static_cast<size_t>(last)].push_back(first_row + k);
    }
    for (size_t n = 0; n < bodies.size(); ++n) {
        for (int c = 0; c < 6; ++c) order.push_back(6 * bodies[n] + c);
        order.insert(order.end(), rows_after[n].begin(), rows_after[n].end());
    }
    return order;
}

}  // namespace

Tangent::Tangent(const System& system)
    : system(system), C(system.pattern()), V(C.entry.size(), Row::Zero()), H(C), d_nu(C),
      d_load(system.load_pattern())
{
    std::map<std::pair<int, int>, int> found;
    const auto find_or_add = [&](int on, int by) {
        const auto [at, is_new] = found.try_emplace({on, by}, static_cast<int>(block.size()));
        if (is_new) block.push_back({.on = on, .by = by});
        return at->second;
    };
    for (int i = 0; i < system.bodies(); ++i) find_or_add(i, i);
    for (int k = 0; k < C.rows(); ++k)
        for (int a = C.start[k]; a < C.start[k + 1]; ++a)
            for (int b = C.start[k]; b < C.start[k + 1]; ++b)
                second_at.push_back(find_or_add(C.entry[a].body, C.entry[b].body));
    for (const LoadVariation::Block& b : d_load.block) load_at.push_back(find_or_add(b.on, b.by));
}

void Tangent::evaluate(const State& x)
{
    system.variation(x, C);
    system.second_variation(x, H);
    system.load_variation(x, d_load);
    for (Block& b : block) b.K.setZero(), b.D.setZero();
    for (int i = 0; i < system.bodies(); ++i) {
        const Mat3& J_bar = system.mass().J_bar[static_cast<size_t>(i)];
        const Vec3& omega_bar = x.body[static_cast<size_t>(i)].omega_bar;
        block[static_cast<size_t>(i)].D.bottomRightCorner<3, 3>() =
            tilde(omega_bar) * J_bar - tilde(J_bar * omega_bar);
    }
    size_t n = 0;
    for (int k = 0; k < C.rows(); ++k)
        for (int a = 0; a < H.entries[k]; ++a)
            for (int b = 0; b < H.entries[k]; ++b)
                block[static_cast<size_t>(second_at[n++])].K += x.lambda[k] * H.at(k, a, b);
    for (size_t l = 0; l < load_at.size(); ++l) {
        Block& b = block[static_cast<size_t>(load_at[l])];
        b.K -= d_load.block[l].d.leftCols<6>();
        b.D -= d_load.block[l].d.rightCols<6>();
    }
}

void Tangent::evaluate_with_velocities(const State& x)
{
    evaluate(x);
    system.nu_variation(x, d_nu);
    for (int k = 0; k < C.rows(); ++k)
        for (int b = 0; b < H.entries[k]; ++b) {
            const int n = C.start[k] + b;
            V[n] << -d_nu.entry[n].r.transpose(), -d_nu.entry[n].pi.transpose();
            for (int a = 0; a < H.entries[k]; ++a) {
                const Motion& body = x.body[static_cast<size_t>(C.entry[C.start[k] + a].body)];
                V[n] += body.rdot.transpose() * H.at(k, a, b).topRows<3>();
                V[n] += body.omega_bar.transpose() * H.at(k, a, b).bottomRows<3>();
            }
        }
}

template <class Scalar>
TangentMatrix<Scalar>::TangentMatrix(const Tangent& tangent, Constraints constraints)
    : rotation(static_cast<size_t>(tangent.system.bodies()), Matrix3::Identity()), tangent(tangent),
      constraints(constraints)
{
    const Rows& C = tangent.C;
    const int m = 6 * tangent.system.bodies();
    for (const Tangent::Block& b : tangent.block) block_at.push_back(N.declare(6 * b.on, 6 * b.by, 6, 6));
    for (int k = 0; k < C.rows(); ++k)
        for (int n = C.start[k]; n < C.start[k + 1]; ++n) {
            row_at.push_back(N.declare(m + k, 6 * C.entry[n].body, 1, 6));
            column_at.push_back(N.declare(6 * C.entry[n].body, m + k, 6, 1));
        }
    for (const int k : C.unilateral) inactive_at.push_back(N.declare(m + k, m + k, 1, 1));
    N.analyse(m + C.rows(), order_of_unknowns(tangent));
}

template <class Scalar>
void TangentMatrix<Scalar>::assemble(Scalar d, Scalar k, Scalar p)
{
    using Matrix6 = Eigen::Matrix<Scalar, 6, 6>;
    const Mass& mass = tangent.system.mass();
    N.set_zero();
    Matrix6 sum;
    for (size_t n = 0; n < tangent.block.size(); ++n) {
        const Tangent::Block& b = tangent.block[n];
        sum = d * b.D.template cast<Scalar>();
        sum.template leftCols<3>() += k * p * b.K.template leftCols<3>().template cast<Scalar>();
        sum.template rightCols<3>().noalias() +=
            k * (b.K.template rightCols<3>().template cast<Scalar>() * rotation[static_cast<size_t>(b.by)]);
        if (b.on == b.by) {
            sum.template topLeftCorner<3, 3>() += mass.m[static_cast<size_t>(b.on)] * Mat3::Identity();
            sum.template bottomRightCorner<3, 3>() += mass.J_bar[static_cast<size_t>(b.on)];
        }
        N.add(block_at[n], sum);
    }
    const bool velocity = constraints == Constraints::velocity;
    Eigen::Matrix<Scalar, 1, 6> row;
    Tangent::Row C_row;
    for (size_t n = 0; n < row_at.size(); ++n) {
        const Rows::Entry& entry = tangent.C.entry[n];
        C_row << entry.r.transpose(), entry.pi.transpose();
        const Tangent::Row& by_pose = velocity ? tangent.V[n] : C_row;
        row.template head<3>() = p * by_pose.template head<3>().template cast<Scalar>();
        row.template tail<3>().noalias() =
            by_pose.template tail<3>().template cast<Scalar>() * rotation[static_cast<size_t>(entry.body)];
        if (velocity) row += C_row.template cast<Scalar>();
        N.add(row_at[n], row);
        N.add(column_at[n], C_row.transpose());
    }
    for (size_t n = 0; n < inactive_at.size(); ++n)
        if (tangent.C.is_inactive(tangent.C.unilateral[n])) N.add(inactive_at[n], Scalar(1));
}

template class TangentMatrix<double>;
template class TangentMatrix<std::complex<double>>;

}  // namespace hilda::lie
