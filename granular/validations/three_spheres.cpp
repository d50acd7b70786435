// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/validations/three_spheres.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace hilda::granular {

namespace {

constexpr double R = 0.15, g = 9.81;
constexpr int grams = 10, max_mass = 256;  // increment of the mass [g], and the largest mass in increments

Material sphere_material(const std::string& name) { return {name, 1000, 2e6, 0.3}; }

PairLaw law(const Stack& stack, const StackRun& run, bool ground)
{
    const auto mu_r = static_cast<float>(stack.mu_r * (ground ? run.ground : 1));
    PairLaw law = hertz_mindlin(sphere_material(""), 0.4, stack.mu);
    if (run.rolling == StackRolling::half_radius)
        law.rolling = ConstantTorque{.mu_r = mu_r, .slow = 1e-4f, .half_radius = 1};
    else
        law.rolling = Epsd{.mu_r = mu_r, .eta_r = 0.3f};
    return law;
}

/// One material for each pair (μ, μ_r), and the last one for the ground
class Materials {
public:
    explicit Materials(const std::vector<Stack>& stacks)
    {
        for (const Stack& s : stacks) number.try_emplace({s.mu, s.mu_r}, static_cast<int>(number.size()));
    }
    int of(const Stack& s) const { return number.at({s.mu, s.mu_r}); }
    int ground() const { return static_cast<int>(number.size()); }

    World world(const WorldOptions& options, const StackRun& run) const
    {
        World world(options, std::vector<Material>(number.size() + 1, sphere_material("sphere")));
        for (const auto& [of, k] : number) {
            const Stack s{.gap = 0, .mu = of.first, .mu_r = of.second};
            for (int other = 0; other <= k; ++other) world.set_law(k, other, law(s, run, false));
            world.set_law(k, ground(), law(s, run, true));
        }
        return world;
    }

private:
    std::map<std::pair<double, double>, int> number;
};

std::vector<double> computed_heights(const std::vector<Stack>& stacks, const std::vector<double>& top,
                                     const StackRun& run)
{
    WorldOptions options;
    options.low = {-8 * R, -2 * R, -R}, options.high = {8 * R, 2 * R, 5 * R};
    options.gravity = {0, 0, -g}, options.h = run.h, options.device = run.device;
    const Materials materials(stacks);
    World world = materials.world(options, run);
    world.add(Boundary{.material = materials.ground()});
    const std::size_t n = stacks.size();
    Particle p;
    p.radius = R;
    for (std::size_t k = 0; k < n; ++k) {
        p.mass = 1, p.material = materials.of(stacks[k]), p.replica = static_cast<std::uint16_t>(k);
        for (const double side : {-1., 1.}) {
            p.r = {side * R * (1 + stacks[k].gap / 2), 0, R};
            world.add(p);
        }
    }
    world.step(std::lround(run.settle / run.h));

    // the upper sphere is placed in contact with both, without overlap
    const std::vector<Particle> settled = world.particles();
    for (std::size_t k = 0; k < n; ++k) {
        const Vec3 left = settled[2 * k].r, right = settled[2 * k + 1].r;
        const double half = (right.x - left.x) / 2;
        p.mass = top[k], p.material = materials.of(stacks[k]), p.replica = static_cast<std::uint16_t>(k);
        p.r = {(left.x + right.x) / 2, 0, (left.z + right.z) / 2 + std::sqrt(4 * R * R - half * half)};
        world.add(p);
    }
    world.step(std::lround(run.watch / run.h));
    run.ended(world);

    const std::vector<Particle> now = world.particles();
    std::vector<double> z(n);
    for (std::size_t k = 0; k < n; ++k) z[k] = now[2 * n + k].r.z / R;
    return z;
}

}  // namespace

std::vector<double> heights(const std::vector<Stack>& stacks, const std::vector<double>& top,
                            const StackRun& run)
{
    std::vector<double> z;
    run.kept.part([&] { z = computed_heights(stacks, top, run); }, [&](io::Archive& a) { a.list(z); });
    return z;
}

std::vector<double> critical_masses(const std::vector<Stack>& stacks, const StackRun& run,
                                    const std::function<void(double)>& progress)
{
    const std::size_t n = stacks.size();
    std::vector<int> stable(n, 0), collapsed(n, max_mass);
    std::vector<double> mass(n);
    for (int width = max_mass; width > 1; width /= 2) {
        for (std::size_t k = 0; k < n; ++k) {
            const int middle = (stable[k] + collapsed[k]) / 2;
            mass[k] = middle * grams / 1000.;
        }
        const std::vector<double> z = heights(stacks, mass, run);
        for (std::size_t k = 0; k < n; ++k)
            (z[k] < collapse_height ? collapsed[k] : stable[k]) = (stable[k] + collapsed[k]) / 2;
        progress(1 - std::log2(width / 2.) / std::log2(max_mass));
    }
    for (std::size_t k = 0; k < n; ++k) mass[k] = collapsed[k] * grams / 1000.;
    return mass;
}

double static_limit(const Stack& s, double lever_ground, double lever_top)
{
    const double sine = (1 + s.gap / 2) / 2, cosine = std::sqrt(1 - sine * sine);
    const double N = 1 / (cosine + s.mu * sine);  // for W = 1
    const double pushes = N * (sine - s.mu * cosine);
    const double slides = pushes > s.mu ? s.mu / (pushes - s.mu) : std::numeric_limits<double>::infinity();
    const double torque = s.mu_r * lever_ground;
    const double excess = pushes - s.mu * N - s.mu_r * lever_top * N - torque;
    return 2 * (excess > 0 ? std::min(slides, torque / excess) : slides);
}

}  // namespace hilda::granular
