// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/ida_solver.hpp"

namespace hilda::reference {

namespace {

[[maybe_unused]] const bool enrolled =
    lie::enrol<IdaSolver>({.name = "ida-rp",
                           .order = 5,
                           .order_lambda = 5,
                           .formulation = "rp",
                           .unknowns = "r, p, r', p', lambda, mu",
                           .source = "SUNDIALS IDA, GGL index 2; Fang (2022), Eq. 2.23",
                           .adaptive = true});

}  // namespace

}  // namespace hilda::reference
