// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/compliant/contact_group.hpp"

#include "contact/detection/broad_phase.hpp"
#include "contact/surfaces/plane.hpp"
#include "dae/model.hpp"

#include <algorithm>

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

ContactGroup::ContactGroup(std::string name, const dae::Model& model, ContactPairs pairs, Shape shape_i,
                           Shape shape_j, std::shared_ptr<const NormalLaw> law,
                           std::shared_ptr<const FrictionModel> friction)
    : name(std::move(name)), shape_i(std::move(shape_i)), shape_j(std::move(shape_j)), model(model),
      of(std::move(pairs)), law(std::move(law)), friction(std::move(friction))
{
    first_force = force(of.first_number());
}

bool ContactGroup::may_have(const NormalLaw& law)
{
    return !(law.force({.overlap = -1, .overlap_rate = 0, .curvature = 1, .m = 1}) > 0);
}

std::array<int, 2> ContactGroup::bodies(int number) const
{
    const auto [i, j] = of.pair(number);
    return {i, j};
}

std::unique_ptr<dae::Force> ContactGroup::force(int number) const
{
    const auto [i, j] = of.pair(number);
    return std::make_unique<ContactForce>(of.name_of_pair(model, name, i, j), model, i, shape_i, j, shape_j,
                                          law, friction);
}

double ContactGroup::reach(int body) const
{
    double smallest = -1;
    const auto add = [&](bool is_member, const Shape& shape) {
        if (!is_member) return;
        const double r = shape.position.norm() + radius_of(*shape.surface);
        smallest = smallest < 0 ? r : std::min(smallest, r);
    };
    add(of.place_in_first(body) >= 0, shape_i);
    add(of.place_in_second(body) >= 0, shape_j);
    return smallest;
}

void ContactGroup::find(const std::vector<Motion>& body, std::span<const double> motion,
                        std::vector<int>& numbers) const
{
    numbers.clear();
    std::vector<Vec3> centre;
    std::vector<double> reach;
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
        BroadPhase phase;
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
}

}  // namespace hilda::contact
