// SPDX-License-Identifier: GPL-3.0-or-later
/// tree-euler-1: semi-implicit Euler method in the joint coordinates of a tree.
///
///     w_{n+1} = w_n + h q̈(q_n, w_n),   q_{n+1} = q_n + h w_{n+1}
///
/// Where q is a rotation, R_{n+1} = R_n exp(h w̃_{n+1}). lie/steps/tree_step.hpp has the variables.

#include "lie/schemes.hpp"
#include "lie/steps/tree_step.hpp"

namespace hilda::lie {
namespace {

class TreeEuler1 final : public TreeStep {
public:
    TreeEuler1(const System& model, const Settings& settings) : TreeStep(model, settings), change(variables())
    {}

    int step(State& x, double h) override
    {
        x_n = x;
        Attempt attempt(x, x_n);
        begin_stages();
        change.tail(freedoms) = h * wdot;
        change.head(freedoms) = h * (w_n + change.tail(freedoms));
        place(x, change);
        x.t = x_n.t + h;
        return done(attempt, finish(x, "tree-euler-1"));
    }

private:
    Eigen::VectorXd change;
};

const bool registered_tree_euler_1 =
    register_scheme<TreeEuler1>({.name = "tree-euler-1",
                                 .description = "semi-implicit Euler in the joint coordinates of a tree",
                                 .order = 1,
                                 .order_lambda = 1,
                                 .formulation = "tree",
                                 .unknowns = "none",
                                 .uses = {"--linear-solver"},  // for the multipliers
                                 .source = "Featherstone (1983)",
                                 .needs_tree = true,
                                 .supports = {Feature::history}});

}  // namespace
}  // namespace hilda::lie
