// SPDX-License-Identifier: GPL-3.0-or-later
/// Direct shear of a sample of grains (Fang 2022, Sec. 7.2.2).
///
/// The grains settle in a box of two halves. A lid of mass σ b²/g, which is free in the vertical direction,
/// presses the sample. The upper half and the lid then move horizontally at a constant speed. The shear
/// stress is the horizontal load of both over the present area of the shear plane:
///
///     τ = (F_x of the lid + F_x of the upper half)/(b (b - x))
///
/// The published program divides by b (b - 2 x). The area that both halves have in common is b (b - x).

#include "granular/validations/shear.hpp"

#include "granular/backend/split_mix.hpp"
#include "granular/mesh/mesh_shapes.hpp"
#include "granular/validations/bed_geometry.hpp"
#include "granular/validations/settling.hpp"
#include "granular/validations/straight_line.hpp"
#include "io/message.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

namespace hilda::granular {

namespace {

constexpr double g = 9.81, restitution = 0.87, restitution_wall = 0.5, mu_wall = 0.4;
constexpr double upper = 0.09;           ///< height of the upper half [m]
constexpr double longest_settling = 2;   // [s]
constexpr double settled_energy = 1e-2;  ///< largest kinetic energy per grain [m g R]
constexpr const char* run_id = "shear";

enum MaterialNumber { grain, wall };

Material glass() { return {"glass", 2550, 4e7, 0.22}; }

/// Adds a plate to a mesh, a rectangle over x and y at z = 0. Equal vertices become one.
void add_plate(TriangleMesh& mesh, double low_x, double high_x, double half_y, bool upwards)
{
    const auto vertex = [&](const Vec3& r) {
        const auto found = std::find(mesh.vertex.begin(), mesh.vertex.end(), r);
        if (found == mesh.vertex.end()) return mesh.vertex.push_back(r), mesh.vertex.size() - 1;
        return static_cast<std::size_t>(found - mesh.vertex.begin());
    };
    std::array<std::uint32_t, 4> c{};
    const std::array<Vec3, 4> corners = {
        {{low_x, -half_y, 0}, {high_x, -half_y, 0}, {high_x, half_y, 0}, {low_x, half_y, 0}}};
    for (std::size_t k = 0; k < 4; ++k) c[k] = static_cast<std::uint32_t>(vertex(corners[k]));
    for (const std::array<std::uint32_t, 3>& t : {std::array{c[0], c[1], c[2]}, std::array{c[0], c[2], c[3]}})
        mesh.triangle.push_back(upwards ? t : std::array{t[0], t[2], t[1]});
}

/// The world of a box. The shear plane is z = 0, and the middle of the box is x = y = 0.
struct Box {
    World world;
    ShearBox box;
    int floor = 0, lower_half = 0, upper_half = 0, lid = 0;

    Box(const ShearBox& box, Device device) : world(options(box, device), {glass(), glass()}), box(box)
    {
        world.set_law(grain, grain, hertz_mindlin(glass(), restitution, box.mu));
        world.set_law(grain, wall, hertz_mindlin(glass(), restitution_wall, mu_wall));
        Boundary b;
        b.material = wall, b.r = {0, 0, -box.lower};
        floor = world.add(b);
        b.r = {0, 0, 2 * upper}, b.axis = {0, 0, -1};
        lid = world.add(b);

        // Side walls. The lower half has a horizontal plate in front of the opening, and the upper half one
        // behind it, so that the moving halves close the box.
        const double half = box.edge / 2;
        Boundary m;
        m.material = wall, m.shape = Boundary::Shape::mesh;
        const std::array<bool, 6> sides = {false, false, false, false, true, true};
        TriangleMesh mesh = box_mesh({-half, -half, -box.lower}, {half, half, 0}, sides, true, 0);
        add_plate(mesh, half, 2 * half, half, true);
        lower_half = world.add(m, mesh);
        mesh = box_mesh({-half, -half, 0}, {half, half, upper}, sides, true, 0);
        add_plate(mesh, -2 * half, -half, half, false);
        upper_half = world.add(m, mesh);
    }

    static WorldOptions options(const ShearBox& box, Device device)
    {
        const double side = box.edge + 4 * box.R;
        WorldOptions o;
        o.low = {-side, -side, -box.lower - box.R}, o.high = {side, side, 2 * upper};
        o.gravity = {0, 0, -g}, o.h = box.h, o.device = device;
        return o;
    }

    double of_grain() const { return sphere_mass(box.R, glass().density); }

    /// A loose lattice with random displacements and velocities
    void fill()
    {
        constexpr double packing = 0.6;
        const double R = box.R, width = box.edge - 2 * R, spacing = 2.1 * R, free = 0.02 * R;
        const int row = static_cast<int>(width / spacing) + 1;
        const double pitch = width / (row - 1);
        const auto count = static_cast<int>(
            std::lround(packing * box.edge * box.edge * box.depth * glass().density / of_grain()));
        Random random(1);
        const auto in = [&](double most) { return random.number(-most, most); };
        for (int k = 0; k < count; ++k) {
            const auto place = [&](int at) {
                return std::clamp(at * pitch + in(free), 0., width) - width / 2;
            };
            Particle p;
            p.radius = R;
            p.r.x = place(k % row), p.r.y = place(k / row % row);
            const int layer = k / (row * row);
            p.r.z = -box.lower + 1.05 * R + layer * spacing + in(free);
            p.v = {in(0.1), in(0.1), in(0.1)};
            world.add(p);
        }
    }

    void settle(const std::function<void(double)>& progress)
    {
        granular::settle(world,
                         {.what = "the sample",
                          .interval = std::lround(0.01 / box.h),
                          .longest = longest_settling,
                          .energy = settled_energy},
                         progress);
    }

    /// Puts the lid on the highest grain, free to move vertically. Its load grows linearly for half of the
    /// time, so that the lid does not rebound.
    void press(double mass, double time)
    {
        Boundary& b = world.boundary(lid);
        b.r.z = highest_point(equal_spheres(world, box.R)), b.mass = mass, b.free = {false, false, true};
        constexpr int parts = 100;
        for (int k = 0; k < 2 * parts; ++k) {
            world.boundary(lid).F.z = mass * g * std::max(0., 1 - (k + 1.) / parts);
            world.step(std::lround(time / box.h / (2 * parts)));
        }
    }

    void move(double speed) { world.boundary(lid).v.x = world.boundary(upper_half).v.x = speed; }
};

}  // namespace

BedCase bed_case(const ShearBox& box)
{
    return {"shear",
            {{"edge", box.edge},
             {"lower", box.lower},
             {"depth", box.depth},
             {"R", box.R},
             {"h", box.h},
             {"density", glass().density},
             {"E", glass().E},
             {"nu", glass().nu},
             {"restitution", restitution},
             {"mu", box.mu},
             {"restitution of walls", restitution_wall},
             {"mu of walls", mu_wall},
             {"g", g},
             {"settled energy", settled_energy}}};
}

std::string settled_sample(const ShearBox& box, const ValidationOptions& options,
                           const std::function<void(double)>& progress)
{
    std::string bytes;
    options.beds.bed(
        bed_case(box),
        [&] {
            Box now(box, options.device);
            now.fill();
            now.settle(progress);
            bytes = now.world.to_bytes(run_id);
        },
        [&](io::Archive& a) { a.list(bytes); });
    return bytes;
}

double ShearRecord::mean(const std::vector<double>& column, double from, double to) const
{
    double sum = 0, count = 0;
    for (std::size_t k = 0; k < x.size(); ++k)
        if (x[k] > from && x[k] < to) sum += column[k], count += 1;
    return sum / count;
}

ShearRecord::Peak ShearRecord::peak(double window) const
{
    Peak largest;
    const double half = (x[1] - x[0]) / 2;
    for (const double first : x) {
        const double from = first - half, to = from + window;
        if (to > x.back() + 1.01 * half) break;
        if (const double now = max_or_nan(largest.tau, mean(tau, from, to)); now != largest.tau)
            largest = {(from + to) / 2, now};
    }
    return largest;
}

ShearRecord shear(const ShearTest& test, const std::string& sample, const ValidationOptions& options)
{
    const ShearBox& box = test.box;
    Box now(box, options.device);
    World& world = now.world;
    world.from_bytes(sample, run_id, "settled sample");
    const double mass = test.stress * box.edge * box.edge / g;
    now.press(mass, test.pressing);
    now.move(test.speed);

    const auto lid_at = [&] { return world.all_boundaries()[static_cast<std::size_t>(now.lid)].r.z; };
    const double start = lid_at();
    const auto samples = std::lround(test.distance / test.interval),
               loads =
                   std::lround(test.interval / test.speed / box.h / static_cast<double>(test.between_loads));
    double below = 0;  // weight of the grains below the shear plane
    for (const Particle& p : world.particles()) below += p.r.z < 0 ? now.of_grain() * g : 0;
    const double all = mass * g + static_cast<double>(world.count()) * now.of_grain() * g;
    ShearRecord out;
    out.sigma = (all - below) / (box.edge * box.edge);
    for (long k = 0; k < samples; ++k) {
        double horizontal = 0, on_lid = 0, on_lower = 0, on_upper = 0;
        for (long i = 0; i < loads; ++i) {
            world.step(test.between_loads);
            const std::vector<Wrench> on = world.totals().on_boundary;
            const auto F = [&](int b) {
                return (1. / static_cast<double>(loads)) * on[static_cast<std::size_t>(b)].F;
            };
            horizontal -= F(now.lid).x + F(now.upper_half).x;
            on_lid += F(now.lid).z, on_lower -= F(now.floor).z + F(now.lower_half).z;
            on_upper -= F(now.upper_half).z;
        }
        const double x = (static_cast<double>(k) + 0.5) * test.interval, area = box.edge * (box.edge - x);
        out.x.push_back(x), out.tau.push_back(horizontal / area), out.lid.push_back(lid_at() - start);
        out.lid_load.push_back(on_lid / (mass * g));
        out.normal.push_back((on_lower - below) / area);
        out.support.push_back((on_lower + on_upper) / all);
    }
    options.include(io::formatted("%g kPa, %g mm/s, mu = %g", 1e-3 * test.stress, 1e3 * test.speed, box.mu),
                    world);
    return out;
}

namespace {

constexpr double reference_stress = 6.4e3, speed = 0.01;

/// The four normal stresses; then at one stress half of the speed, and grains without friction
std::vector<ShearTest> tests(bool full)
{
    ShearTest test;
    test.speed = speed;
    if (full)
        test.distance = 0.01;
    else
        test.box.R = 4e-3, test.box.h *= 4. / 3;
    std::vector<ShearTest> all;
    for (const double stress : {3.1e3, 6.4e3, 12.5e3, 24.2e3})
        all.push_back(test), all.back().stress = stress;
    test.stress = reference_stress;
    all.push_back(test), all.back().speed = speed / 2;
    all.push_back(test), all.back().box.mu = 0;
    return all;
}

struct Measured {
    ShearTest test;
    ShearRecord record;
};

std::vector<ValidationCheck> checks(const std::vector<Measured>& all)
{
    std::vector<double> sigma, tau;
    double least = 1e300, largest = 0, imbalance = 0, reference = 0, slow = 0, frictionless = 0;
    for (const auto& [test, record] : all) {
        const double peak = record.peak().tau, ratio = peak / record.sigma;
        imbalance = max_or_nan(imbalance, std::abs(record.mean(record.support, 0, test.distance) - 1));
        if (test.box.mu == 0)
            frictionless = ratio;
        else if (test.speed != speed)
            slow = ratio;
        else {
            sigma.push_back(record.sigma), tau.push_back(peak);
            least = min_or_nan(least, ratio), largest = max_or_nan(largest, ratio);
            if (test.stress == reference_stress) reference = ratio;
        }
    }
    const StraightLine line(sigma, tau);
    return {{"largest over smallest tau_peak/sigma of the four stresses", largest / least, 1, 1.1},
            {"r^2 of the line tau_peak(sigma)", line.r2, 0.99, 1},
            {"intercept of this line over the largest tau_peak", line.a / tau.back(), -0.05, 0.05},
            {"vertical load over the weight - 1, largest of all tests", imbalance, 0, 0.01},
            {"tau_peak at 5 mm/s over that at 10 mm/s", slow / reference, 0.95, 1.05},
            {"tau_peak without friction of the grains over that with mu = 0.18", frictionless / reference, 0,
             0.5}};
}

ValidationResult run(const ValidationOptions& options)
{
    const std::vector<ShearTest> all = tests(options.full);
    if (options.full) options.announce("6 shear tests, 5 to 6 minutes of CPU time in the preset native");
    std::set<double> of_samples;
    for (const ShearTest& test : all) of_samples.insert(test.box.mu);
    std::map<double, std::string> samples;  // by mu
    std::vector<ShearRecord> records(all.size());
    double done = 0;
    const auto parts = static_cast<double>(all.size() + of_samples.size());
    const auto compute = [&](long k) {
        const ShearTest& test = all[static_cast<std::size_t>(k)];
        const auto [sample, is_new] = samples.try_emplace(test.box.mu);
        if (is_new) {
            ShearBox box = all.front().box;
            box.mu = test.box.mu;
            sample->second =
                settled_sample(box, options, [&](double share) { options.progress((done + share) / parts); });
            options.progress(++done / parts);
        }
        records[static_cast<std::size_t>(k)] = shear(test, sample->second, options);
        options.progress(++done / parts);
    };
    options.kept.parts(static_cast<long>(all.size()), compute, [&](io::Archive& a, long k) {
        ShearRecord& r = records[static_cast<std::size_t>(k)];
        a.value(r.sigma);
        for (auto* column : {&r.x, &r.tau, &r.lid, &r.lid_load, &r.normal, &r.support}) a.list(*column);
    });

    ValidationTable table{"study",
                          {"R", "stress", "speed", "mu", "sigma", "tau_peak", "x_peak", "ratio", "tau_end",
                           "normal", "support", "dilation"},
                          {}},
        curves{"motion", {"stress", "speed", "mu", "x", "tau", "lid", "lid_load", "normal", "support"}, {}};
    std::vector<Measured> measured;
    for (std::size_t n = 0; n < all.size(); ++n) {
        const ShearTest& test = all[n];
        const ShearRecord& r = records[n];
        const ShearRecord::Peak peak = r.peak();
        table.rows.push_back({test.box.R, test.stress, test.speed, test.box.mu, r.sigma, peak.tau, peak.x,
                              peak.tau / r.sigma, r.mean(r.tau, test.distance / 2, test.distance),
                              r.mean(r.normal, 0, test.distance), r.mean(r.support, 0, test.distance),
                              r.lid.back()});
        for (std::size_t k = 0; k < r.x.size(); ++k)
            curves.rows.push_back({test.stress, test.speed, test.box.mu, r.x[k], r.tau[k], r.lid[k],
                                   r.lid_load[k], r.normal[k], r.support[k]});
        measured.push_back({test, r});
    }
    return {{table, curves}, checks(measured)};
}

const bool registered_shear = io::Registry<Validation>::add(
    {.name = "shear",
     .description =
         "shear stress of a sample of grains over the shear displacement and the normal stress (Fig. 7.12)",
     .run = run,
     .independent_parts = true});

}  // namespace

}  // namespace hilda::granular
