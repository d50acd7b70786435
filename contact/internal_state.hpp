// SPDX-License-Identifier: GPL-3.0-or-later
/// Typed internal states: structs of reals in the flat array State::internal_state.

#pragma once

#include <cstring>

namespace hilda::contact {

/// Number of reals in Values, a struct whose members are doubles and Eigen objects of fixed size, without
/// padding
template <class Values>
constexpr int reals()
{
    static_assert(sizeof(Values) % sizeof(double) == 0);
    return sizeof(Values) / sizeof(double);
}

/// The struct that was saved in the array
template <class Values>
Values restored(const double* saved)
{
    Values values;
    std::memcpy(static_cast<void*>(&values), saved, sizeof values);
    return values;
}

template <class Values>
void save(const Values& values, double* saved)
{
    std::memcpy(saved, static_cast<const void*>(&values), sizeof values);
}

}  // namespace hilda::contact
