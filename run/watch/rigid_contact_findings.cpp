// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/watch/rigid_contact_findings.hpp"

#include <fmt/format.h>

namespace hilda::run {

namespace {

constexpr double largest_overlap = 1e-6;  // relative to the smaller size of two bodies

}  // namespace

std::vector<Finding> rigid_contact_findings(const lie::Statistics& of)
{
    std::vector<Finding> list;
    if (of.friction_relaxed > 0)
        list.push_back({"friction_relaxed",
                        fmt::format("{} of {} steps satisfy Coulomb's law with a slip term that differs from "
                                    "that of their slip, by up to {:.1e} m/s; reduce the step",
                                    of.friction_relaxed, of.steps, of.cone_residual)});
    if (of.restitution_reduced > 0)
        list.push_back({"restitution_reduced",
                        fmt::format("in {} of {} steps Newton's law of impact would increase the energy; the "
                                    "coefficients of restitution of these steps are reduced",
                                    of.restitution_reduced, of.steps)});
    if (of.overlap > largest_overlap)
        list.push_back({"rigid_overlap", fmt::format("rigid bodies overlap by up to {:.1e} of their size; "
                                                     "reduce the step",
                                                     of.overlap)});
    return list;
}

}  // namespace hilda::run
