// SPDX-License-Identifier: GPL-3.0-or-later
/// The numbers of a state in a row, for State::history.

#pragma once

#include "lie/check.hpp"
#include "lie/state.hpp"

#include <algorithm>
#include <string>

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

/// Calls block(numbers, count) for all numbers of x but its time, its history and its applied loads.
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

/// Makes State::history of the numbers for which numbers(block) calls block(numbers, count).
template <class Numbers>
void write_history(State& x, const Numbers& numbers)
{
    Eigen::Index size = 0;
    numbers([&](const double*, Eigen::Index count) { size += count; });
    x.history.resize(size);
    double* to = x.history.data();
    numbers([&](const double* from, Eigen::Index count) { to = std::copy_n(from, count, to); });
}

/// Reads them. Throws InvalidInput if their count is another one.
template <class Numbers>
void read_history(const State& x, const std::string& scheme, const Numbers& numbers)
{
    Eigen::Index size = 0;
    numbers([&](const double*, Eigen::Index count) { size += count; });
    if (x.history.size() != size)
        reject("integrator " + scheme, "State::history must be that of the same scheme; its size",
               x.history.size());
    const double* from = x.history.data();
    numbers([&](double* to, Eigen::Index count) {
        std::copy_n(from, count, to);
        from += count;
    });
}

}  // namespace hilda::lie
