// SPDX-License-Identifier: GPL-3.0-or-later
// Kernels and their weights on grids.
#include "granular/fields/cell_weights.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <random>

using namespace hilda::granular;

namespace kernel_test {

namespace {

const std::array<Kernel, 2> kernels = {Kernel{Kernel::Type::gaussian, 0.7}, Kernel{Kernel::Type::lucy, 1.6}};

/// Composite Simpson rule on [0, 1]
template <class F>
double simpson(int n, const F& f)
{
    double sum = f(0.) + f(1.);
    for (int k = 1; k < 2 * n; ++k) sum += (k % 2 == 1 ? 4 : 2) * f(k / (2. * n));
    return sum / (6 * n);
}

double sum(const std::vector<Footprint>& all)
{
    double weight = 0;
    for (const Footprint& f : all)
        for (const double w : f.weight) weight += w;
    return weight;
}

std::vector<double> on_grid(const FieldGrid& grid, const std::vector<Footprint>& all)
{
    std::vector<double> weight(grid.count());
    for (const Footprint& f : all) {
        const double* w = f.weight.data();
        for (int k = 0; k < f.count[2]; ++k)
            for (int j = 0; j < f.count[1]; ++j)
                for (int i = 0; i < f.count[0]; ++i)
                    weight[grid.number(f.begin[0] + i, f.begin[1] + j, f.begin[2] + k)] += *w++;
    }
    return weight;
}

}  // namespace

TEST_CASE("the integral of a kernel over the space is one", "[granular][fields]")
{
    for (const Kernel& kernel : kernels) {
        // Midpoint rule; the cut of the Gaussian is between points.
        constexpr int n = 120;
        const double h = 2 * kernel.reach() / n;
        double all = 0;
        for (int k = 0; k < n * n * n; ++k) {
            const auto at = [&](int number) { return (number % n + 0.5) * h - kernel.reach(); };
            all += kernel.value({at(k), at(k / n), at(k / n / n)}) * h * h * h;
        }
        INFO(Kernel::names[static_cast<std::size_t>(kernel.type)]);
        CHECK(all == Approx(1).epsilon(kernel.type == Kernel::Type::lucy ? 1e-6 : 2e-5));
    }
}

TEST_CASE("the mean of a kernel on a line agrees with a quadrature", "[granular][fields]")
{
    std::mt19937 random(GENERATE(1, 2, 3, 4, 5, 6));
    std::uniform_real_distribution<double> any(-1.2, 1.2);
    for (const Kernel& kernel : kernels) {
        const Vec3 x = {any(random), any(random), any(random)}, a = {any(random), any(random), any(random)};
        const double exact = kernel.line(x, a);
        const double quadrature = simpson(20000, [&](double s) { return kernel.value(x + s * a); });
        // the quadrature resolves the jump of the cut Gaussian, 1 % of the peak, to a panel
        CHECK(exact == Approx(quadrature).margin(1e-6 * kernel.value({0, 0, 0})));
        CHECK(kernel.line(x, 1e-4 * a) == Approx(kernel.value(x + 5e-5 * a)).epsilon(1e-6).margin(1e-9));
        CHECK(kernel.line(x, {0, 0, 0}) == kernel.value(x));
        CHECK(kernel.line(x, a) == Approx(kernel.line(x + a, -a)).margin(1e-14 * kernel.value({0, 0, 0})));
    }
}

TEST_CASE("a line through the centre of Lucy's kernel has its closed form", "[granular][fields]")
{
    // ∫ (1 - 6 q² + 8 q³ - 3 q⁴) dq from -1 to 1 is 2 (1 - 2 + 2 - 3/5)
    const Kernel kernel = kernels[1];
    const double peak = 105 / (16 * M_PI * std::pow(kernel.width, 3));
    CHECK(kernel.line({-2, 0, 0}, {4, 0, 0}) == Approx(peak * 0.8 * kernel.width / 4).epsilon(1e-14));
    CHECK(kernel.line({-2, 0, kernel.width}, {4, 0, 0}) == 0);
}

TEST_CASE("weights of cells sum up to one", "[granular][fields]")
{
    const double width = GENERATE(1e-3, 0.05, 0.4, 1.3);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> any(0, 1);
    for (const Kernel::Type type : {Kernel::Type::gaussian, Kernel::Type::lucy}) {
        const Kernel kernel{type, width};
        const FieldGrid wide{.low = {-5, -5, -5}, .high = {6, 6, 6}, .cells = {23, 1, 17}},
            periodic{.low = {0, 0, 0}, .high = {1, 1, 1}, .cells = {5, 7, 1}, .period = {1, 1, 1}},
            closed{.low = {0, 0, 0}, .high = {1, 1, 1}, .cells = {5, 7, 1}, .closed = true},
            mixed{
                .low = {0, 0, 0}, .high = {1, 1, 1}, .cells = {4, 3, 6}, .period = {0, 1, 0}, .closed = true};
        for (int k = 0; k < 5; ++k) {
            const Vec3 r = {any(random), any(random), any(random)},
                       other = {any(random), any(random), any(random)};
            INFO(width << " " << static_cast<int>(type));
            for (const FieldGrid& grid : {wide, periodic, closed, mixed}) {
                CHECK(sum(CellWeights(grid, kernel).of_point(r)) == Approx(1).epsilon(1e-14));
                // rounding of up to 7000 quadrature points
                CHECK(sum(CellWeights(grid, kernel).of_line(r, other - r)) == Approx(1).epsilon(1e-13));
            }
            // an image of the particle is the same particle
            const std::vector<double> one = on_grid(periodic, CellWeights(periodic, kernel).of_point(r)),
                                      image =
                                          on_grid(periodic,
                                                  CellWeights(periodic, kernel).of_point(r + Vec3{1, -2, 0}));
            for (std::size_t cell = 0; cell < one.size(); ++cell)
                CHECK(image[cell] == Approx(one[cell]).margin(1e-12));
        }
        CHECK(sum(CellWeights(closed, kernel).of_point({0.5, 1.01, 0.5})) == 0);
        CHECK(sum(CellWeights(closed, kernel).of_point({0.5, 0, -1e-17})) == Approx(1).epsilon(1e-14));
    }
}

TEST_CASE("an open grid has the part of a kernel that is inside", "[granular][fields]")
{
    const FieldGrid half{.low = {-3, -3, 0}, .high = {3, 3, 3}, .cells = {12, 12, 6}};
    for (const Kernel& kernel : kernels)
        CHECK(sum(CellWeights(half, kernel).of_point({0, 0, 0})) == Approx(0.5).epsilon(1e-13));
}

TEST_CASE("the mean over a cell is that of the values in it", "[granular][fields]")
{
    // One cell against the values at the centres of n³ cells in its place. The sums of the cut Gaussian are
    // of first order, because of its jump of 1 % of the peak.
    const FieldGrid cell{.low = {-0.2, 0.1, -0.6}, .high = {0.6, 0.7, 0.2}};
    FieldGrid points = cell;
    points.cells = {40, 40, 40}, points.values = FieldGrid::Values::points;
    const Vec3 r = {-0.4, 0.3, 0.1}, a = {0.9, -0.2, 0.3};
    for (const Kernel& kernel : kernels) {
        const double limit = kernel.type == Kernel::Type::lucy ? 1e-3 : 1e-4;
        CHECK(sum(CellWeights(cell, kernel).of_point(r)) ==
              Approx(sum(CellWeights(points, kernel).of_point(r))).epsilon(limit));
        CHECK(sum(CellWeights(cell, kernel).of_line(r, a)) ==
              Approx(sum(CellWeights(points, kernel).of_line(r, a))).epsilon(limit));
    }
}

}  // namespace kernel_test
