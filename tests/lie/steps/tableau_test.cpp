// SPDX-License-Identifier: GPL-3.0-or-later
/// Order conditions of the tableaux and of their continuous extensions.

#include "lie/steps/tableau.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <utility>
#include <vector>

using namespace hilda;
using lie::Tableau;

namespace {

/// A rooted tree: the subtrees of its root, by their number in the list
struct Tree {
    int order = 1;
    double density = 1;  ///< γ: order times the densities of the subtrees
    std::vector<size_t> subtrees = {};
};

/// All rooted trees up to an order: 1, 1, 2, 4, 9, 20, 48, 115 of the orders 1 to 8
std::vector<Tree> trees(int most)
{
    std::vector<Tree> all = {{}};
    for (int order = 2; order <= most; ++order) {
        const size_t known = all.size();
        // Subtrees in descending order of their numbers, so that no tree occurs twice
        const std::function<void(Tree, int, size_t)> add = [&](const Tree& t, int left, size_t last) {
            if (left == 0) {
                all.push_back(t);
                all.back().order = order;
                all.back().density *= order;
                return;
            }
            for (size_t k = 0; k <= last && k < known; ++k) {
                if (all[k].order > left) continue;
                Tree more = t;
                more.subtrees.push_back(k);
                more.density *= all[k].density;
                add(more, left - all[k].order, k);
            }
        };
        add({}, order - 1, known - 1);
    }
    return all;
}

/// The product of the stage values of the subtrees of each tree, for each stage
std::vector<std::vector<double>> stage_values(const Tableau& tableau, const std::vector<Tree>& all)
{
    std::vector<std::vector<double>> values;
    for (const Tree& tree : all) {
        std::vector<double> of_stage(static_cast<size_t>(tableau.all_stages()), 1.);
        for (size_t i = 0; i < of_stage.size(); ++i)
            for (const size_t sub : tree.subtrees) {
                double sum = 0;
                for (size_t j = 0; j < tableau.a[i].size(); ++j) sum += tableau.a[i][j] * values[sub][j];
                of_stage[i] *= sum;
            }
        values.push_back(of_stage);
    }
    return values;
}

/// The largest error of the conditions Σ weights_i Φ_i(tree) = s^order/γ for trees of an order
template <class Weights>
double defect(const Tableau& tableau, const Weights& weights, int order, double s)
{
    const std::vector<Tree> all = trees(order);
    const auto values = stage_values(tableau, all);
    double largest = 0;
    for (size_t k = 0; k < all.size(); ++k) {
        if (all[k].order != order) continue;
        double sum = 0;
        for (size_t i = 0; i < weights.size(); ++i) sum += weights[i] * values[k][i];
        largest = std::max(largest, std::abs(sum - std::pow(s, order) / all[k].density));
    }
    return largest;
}

std::vector<double> difference(const std::vector<double>& b, const std::vector<double>& e, size_t stages)
{
    std::vector<double> out(stages);
    for (size_t i = 0; i < stages; ++i)
        out[i] = Tableau::entry(b, static_cast<int>(i)) - Tableau::entry(e, static_cast<int>(i));
    return out;
}

constexpr double rounding = 1e-13;

}  // namespace

TEST_CASE("the number of rooted trees is that of Cayley's sequence", "[lie][tableau]")
{
    const std::vector<Tree> all = trees(8);
    CHECK(all.size() == 1 + 1 + 2 + 4 + 9 + 20 + 48 + 115);
}

TEST_CASE("a tableau satisfies the conditions of its order and not those of the next", "[lie][tableau]")
{
    for (const Tableau* tableau : {&lie::dormand_prince_5(), &lie::dop853()}) {
        INFO(tableau->name);
        for (size_t i = 0; i < tableau->a.size(); ++i) {
            double sum = 0;
            for (const double a : tableau->a[i]) sum += a;
            CHECK(sum == Approx(tableau->c[i]).margin(4e-15));
        }
        const std::vector<double>& b = tableau->a[static_cast<size_t>(tableau->stages())];
        for (int order = 1; order <= tableau->order; ++order) CHECK(defect(*tableau, b, order, 1) < rounding);
        CHECK(defect(*tableau, b, tableau->order + 1, 1) > 1e-7);
    }
}

TEST_CASE("the embedded methods have their orders", "[lie][tableau]")
{
    const Tableau &dp = lie::dormand_prince_5(), &dop = lie::dop853();
    const auto check = [](const Tableau& tableau, size_t estimate, int order) {
        const auto stages = static_cast<size_t>(tableau.all_stages());
        const std::vector<double> b =
            difference(tableau.a[static_cast<size_t>(tableau.stages())], tableau.error[estimate], stages);
        INFO(tableau.name << ", estimate " << estimate);
        for (int q = 1; q <= order; ++q) CHECK(defect(tableau, b, q, 1) < rounding);
        CHECK(defect(tableau, b, order + 1, 1) > 1e-6);
    };
    check(dp, 0, 4);
    check(dop, 0, 5);
    check(dop, 1, 3);
}

TEST_CASE("the continuous extensions are of the orders 4 and 7 at every instant", "[lie][tableau]")
{
    for (const auto& [tableau, order] : {std::pair(&lie::dormand_prince_5(), 4), {&lie::dop853(), 7}}) {
        std::vector<double> b(static_cast<size_t>(tableau->all_stages()));
        for (const double s : {0.1, 0.3, 0.5, 0.77, 1.}) {
            tableau->interpolation(s, b);
            INFO(tableau->name << " at " << s);
            for (int q = 1; q <= order; ++q) CHECK(defect(*tableau, b, q, s) < rounding);
            if (s < 1) CHECK(defect(*tableau, b, order + 1, s) > 1e-8);
        }
        tableau->interpolation(1, b);
        const std::vector<double>& end = tableau->a[static_cast<size_t>(tableau->stages())];
        for (size_t i = 0; i < b.size(); ++i)
            CHECK(b[i] == Approx(Tableau::entry(end, static_cast<int>(i))).margin(1e-14));
    }
}
