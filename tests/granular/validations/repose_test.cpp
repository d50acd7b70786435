// SPDX-License-Identifier: GPL-3.0-or-later
// Angle of repose of a heap on a plate.
#include "granular/validations/repose.hpp"

#include <catch2/catch.hpp>

#include <omp.h>

#include <cmath>

using namespace hilda::granular;

namespace {

/// Sum of the surface over its x, times the distance of the points [m²]
double area(const HeapSurface& s)
{
    double sum = 0;
    for (const double z : s.z) sum += z * (s.x[1] - s.x[0]);
    return sum;
}

}  // namespace

TEST_CASE("the surface of one sphere is a hemisphere, also across the period", "[granular][repose]")
{
    const Heap heap{.d = 0.01, .width = 10, .length = 4};
    const double R = 0.45 * heap.period(), volume = 2 * M_PI / 3 * R * R * R;
    for (const double y : {0., 0.3, 0.5, -0.5}) {
        const HeapSurface s = surface_of({{{0.1 * heap.edge(), y * heap.period(), 0}, R}}, heap);
        INFO("y = " << y);
        CHECK(s.x.size() == 40);
        CHECK(area(s) * heap.period() == Approx(volume).epsilon(0.02));
        for (std::size_t k = 0; k < s.x.size(); ++k) {
            const bool covered = std::abs(s.x[k] - 0.1 * heap.edge()) < 0.9 * R;
            if (covered) CHECK(s.z[k] > 0);
            if (std::abs(s.x[k] - 0.1 * heap.edge()) > R) CHECK(s.z[k] == 0);
        }
    }
}

TEST_CASE("the higher of two spheres is the surface, and a sphere beyond the plate is cut off",
          "[granular][repose]")
{
    const Heap heap{.d = 0.01, .width = 10, .length = 4};
    const BedSphere low{{0, 0, 0}, 0.01}, high{{0, 0, 0.05}, 0.01};
    CHECK(surface_of({low, high}, heap).z == surface_of({high, low}, heap).z);
    CHECK(surface_of({low, high}, heap).z == surface_of({high}, heap).z);
    const double whole = area(surface_of({low}, heap));
    CHECK(area(surface_of({{{heap.edge(), 0, 0}, 0.01}}, heap)) == Approx(whole / 2).epsilon(0.02));
    CHECK(area(surface_of({{{heap.edge() + 0.02, 0, 0}, 0.01}}, heap)) == 0);
}

TEST_CASE("the angles of the flanks of a roof", "[granular][repose]")
{
    const Heap heap;
    HeapSurface s;
    for (int k = -50; k < 50; ++k) {
        const double x = (k + 0.5) / 50 * heap.edge();
        s.x.push_back(x), s.z.push_back(x < 0 ? 0.1 + 0.5 * x : 0.1 - 0.25 * x);
    }
    s.z[0] = s.z[50] = 1;  // at an edge and in the middle
    const FlankAngles a = flank_angles(s, heap);
    CHECK(a.left == Approx(std::atan(0.5) * 180 / M_PI));
    CHECK(a.right == Approx(std::atan(0.25) * 180 / M_PI));
    CHECK(a.mean() == Approx((a.left + a.right) / 2));
    CHECK(a.r2 == Approx(1));
    s.z[10] = std::nan("");
    CHECK(std::isnan(flank_angles(s, heap).r2));
}

TEST_CASE("a heap is the same for any number of threads, and friction makes it steeper (long)",
          "[granular][repose]")
{
    Heap heap{.width = 16, .length = 5, .height = 6};
    const int threads = omp_get_max_threads();
    omp_set_num_threads(1);
    const RestingHeap one = resting_heap(heap, {});
    omp_set_num_threads(3);
    const RestingHeap three = resting_heap(heap, {});
    omp_set_num_threads(threads);
    REQUIRE(one.spheres.size() == three.spheres.size());
    for (std::size_t k = 0; k < one.spheres.size(); ++k) {
        CHECK(one.spheres[k].r == three.spheres[k].r);
        CHECK(one.spheres[k].radius == three.spheres[k].radius);
    }
    CHECK(std::abs(one.balance) < 1e-12);
    CHECK(one.grains > 100);
    for (const BedSphere& s : one.spheres) CHECK(std::abs(s.r.x) < heap.edge() + heap.d);

    const double steep = flank_angles(surface_of(one.spheres, heap), heap).mean();
    heap.mu = 0.05, heap.mu_r = 0;
    const RestingHeap smooth = resting_heap(heap, {});
    CHECK(smooth.grains < one.grains);
    CHECK(flank_angles(surface_of(smooth.spheres, heap), heap).mean() < steep - 5);
}
