// SPDX-License-Identifier: GPL-3.0-or-later
/// The numbers of a state in a row, for State::history.

#pragma once

#include "lie/state.hpp"

namespace hilda::lie {

/// Copies all but the history.
void copy(const State& from, State& to);

/// Calls block(&number, 1) for an integer, as a floating-point number.
template <class Integer, class Block>
void transfer_integer(Integer& value, const Block& block)
{
    auto number = static_cast<double>(value);
    block(&number, 1);
    value = static_cast<Integer>(number);
}

/// Calls block(numbers, count) for all numbers of x but its time and its history.
template <class Block>
void transfer(State& x, const Block& block)
{
    static_assert(sizeof(Motion) == 24 * sizeof(double), "a motion consists of 24 numbers without padding");
    if (!x.body.empty()) block(x.body[0].r.data(), static_cast<Eigen::Index>(24 * x.body.size()));
    block(x.alpha.data(), x.alpha.size());
    block(x.lambda.data(), x.lambda.size());
    for (int& state : x.discrete_state) transfer_integer(state, block);
    block(x.internal_state.data(), static_cast<Eigen::Index>(x.internal_state.size()));
}

}  // namespace hilda::lie
