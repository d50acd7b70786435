// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/detection/near_pairs.hpp"

#include "contact/detection/broad_phase.hpp"
#include "contact/detection/detectors.hpp"
#include "contact/surfaces/plane.hpp"
#include "dae/body.hpp"

#include <algorithm>
#include <limits>

namespace hilda::contact {

namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();
constexpr double allowance = 1e-9;  // of a radius and a distance, for rounding

/// Bounding sphere of a surface: about its own centre for the ground, else about the centre of mass
struct Ball {
    Vec3 centre;
    double reach;
};

double radius_of(const Surface& s) { return s.sigma() < 0 ? unbounded : s.bounding_radius(); }

Ball ball_of(int b, const Shape& shape, const std::vector<Motion>& body)
{
    const double radius = radius_of(*shape.surface);
    if (b == dae::ground) return {shape.position, radius};
    return {body[static_cast<size_t>(b)].r, shape.position.norm() + radius};
}

/// Whether the ball is farther from a plane of the ground than it can move
bool is_far_from_plane(const Shape& plane, int of_plane, const Ball& ball)
{
    if (of_plane != dae::ground || surface_as<Plane>(plane) == nullptr) return false;
    const double distance = plane.to_surface(ball.centre).z();
    return distance > ball.reach + allowance * (1 + ball.centre.norm());
}

}  // namespace

double reach_about_centre(const Shape& shape) { return shape.position.norm() + radius_of(*shape.surface); }

long find_near_pairs(const ContactPairs& of, const Shape& shape_i, const Shape& shape_j,
                     const std::vector<Motion>& body, std::span<const double> motion,
                     std::vector<int>& numbers)
{
    long tests = 0;
    numbers.clear();
    static thread_local std::vector<Vec3> centre;
    static thread_local std::vector<double> reach;
    static thread_local BroadPhase phase;
    centre.clear(), reach.clear();
    phase.tests = 0;
    const auto add = [&](const std::vector<int>& list, const Shape& shape) {
        for (const int b : list) {
            const Ball ball = ball_of(b, shape, body);
            const double moves = b == dae::ground ? 0 : motion[static_cast<size_t>(b)];
            centre.push_back(ball.centre);
            reach.push_back((1 + allowance) * ball.reach + (std::isinf(ball.reach) ? 0 : moves));
        }
    };
    add(of.first, shape_i);
    const auto firsts = static_cast<int>(of.first.size());
    if (!of.each_two) add(of.second, shape_j);
    const auto add_pair = [&](int a, int b) {
        if (!of.has(a, b)) return;
        const int i = a, j = of.each_two ? b : firsts + b;
        const auto ball = [&](int item) {
            return Ball{centre[static_cast<size_t>(item)], reach[static_cast<size_t>(item)]};
        };
        if (is_far_from_plane(shape_j, of.second[static_cast<size_t>(b)], ball(i)) ||
            is_far_from_plane(shape_i, of.first[static_cast<size_t>(a)], ball(j)))
            return;
        numbers.push_back(of.number(a, b));
    };
    const auto is_unbounded = [&](size_t item) { return std::isinf(reach[item]); };
    const auto n_first = static_cast<size_t>(firsts);
    if (!of.each_two && (of.first.size() == 1 || of.second.size() == 1)) {
        // one body against many
        const auto limit = [&](size_t a, size_t b) {
            const double sum = reach[a] + reach[n_first + b];
            ++tests;
            return std::isinf(sum) || (centre[a] - centre[n_first + b]).squaredNorm() < sum * sum;
        };
        for (size_t a = 0; a < of.first.size(); ++a)
            for (size_t b = 0; b < of.second.size(); ++b)
                if (limit(a, b)) add_pair(static_cast<int>(a), static_cast<int>(b));
    } else {
        for (const Candidate& c : phase.find(centre, reach, 0)) {
            if (of.each_two)
                add_pair(c.i, c.j);
            else if (c.i < firsts && c.j >= firsts)
                add_pair(c.i, c.j - firsts);
        }
        tests += phase.tests;
        // two unbounded bodies, which the broad phase does not pair
        for (size_t a = 0; a < n_first; ++a)
            if (is_unbounded(a))
                for (size_t b = of.each_two ? a + 1 : 0; b < of.second.size(); ++b)
                    if (is_unbounded(of.each_two ? b : n_first + b))
                        add_pair(static_cast<int>(a), static_cast<int>(b));
    }
    std::sort(numbers.begin(), numbers.end());
    return tests;
}

}  // namespace hilda::contact
