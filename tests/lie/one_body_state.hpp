// SPDX-License-Identifier: GPL-3.0-or-later
/// The numbers of the state of a system with one body.

#pragma once

#include "lie/system.hpp"

namespace hilda::tests {

/// The variables to which Scheme::order applies: r, A, ṙ, ω̄
inline Eigen::VectorXd motion(const lie::State& x)
{
    const lie::Motion& body = x.body[0];
    Eigen::VectorXd q(18);
    q << body.r, Eigen::Map<const Eigen::VectorXd>(body.A.data(), 9), body.rdot, body.omega_bar;
    return q;
}

/// r, A, ṙ, ω̄, r̈, ω̄̇, λ
inline Eigen::VectorXd numbers(const lie::State& x)
{
    const lie::Motion& body = x.body[0];
    Eigen::VectorXd all(24 + x.lambda.size());
    all << body.r, Eigen::Map<const Eigen::VectorXd>(body.A.data(), 9), body.rdot, body.omega_bar, body.rddot,
        body.omegadot_bar, x.lambda;
    return all;
}

}  // namespace hilda::tests
