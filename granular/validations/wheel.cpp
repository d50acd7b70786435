// SPDX-License-Identifier: GPL-3.0-or-later
/// Single wheel with prescribed slip on a bed of grains (Fang 2022, Sec. 7.2.6), in plane strain and as a
/// mesh.
///
/// The wheel is a cylinder or a torus, free in the vertical direction under its load. Its horizontal velocity
/// v and its angular velocity ω are prescribed, with the slip s = 1 - v/(ω radius). The bed is periodic along
/// the axis. All loads are those of the width of 16 cm.
///
///     pull   = horizontal load of the grains on the wheel, positive in the direction of travel (DBP)
///     torque = driving torque of the axle
///     sinkage = z_init(x) - (z - radius)                                            Fang (2022), Eq. 7.7
///
/// with the axis of the wheel at (x, z) and z_init(x) the highest point of the settled bed within 2R of x.
/// The text has a bed with a packing fraction of 0.544. Here the bed settles with a friction of 0.1, so that
/// it is about as dense as that of Johnson et al. (2015, J. Terramech. 62, 31), 0.62, who simulate the same
/// rig.
///
/// The power torque ω - pull v is dissipated in the bed, but for its change of energy.

#include "granular/validations/wheel.hpp"

#include "granular/backend/split_mix.hpp"
#include "granular/mesh/mesh_shapes.hpp"
#include "granular/validations/bed_geometry.hpp"
#include "granular/validations/settling.hpp"
#include "io/message.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

namespace hilda::granular {

namespace {

constexpr double g = 9.81, mu = 0.9, settling_mu_r = 0.2, gamma = 1e3;
constexpr double omega = 17 * std::numbers::pi / 180, wheel_width = 0.16, wheel_load = 80;
constexpr double start_x = 0.18, resting = 0.3;  // [m, s]
constexpr double settled_energy = 1e-3;          ///< largest kinetic energy per grain [m g R]
constexpr double longest_settling = 3;           // [s]

Material rock() { return {"rock", 2500, 1e7, 0.3}; }

PairLaw law(const WheelBed& bed, double friction, double mu_r)
{
    const auto k = static_cast<float>(bed.k);
    const auto bound = static_cast<float>(friction);
    PairLaw l;
    l.normal = ScaledHooke{.k_n = k, .gamma_n = gamma};
    l.tangential = Mindlin{.spring = {.k_t = k, .c = 0, .gamma_t = gamma}, .cap = {bound, bound}};
    if (mu_r > 0) l.rolling = ConstantTorque::with_half_radius(mu_r);
    return l;
}

/// Of the tyre it is the one at the outer equator [m].
double radius_of(WheelShape shape) { return shape == WheelShape::tyre ? 0.305 : 0.13; }

bool is_plane_strain(WheelShape shape) { return shape == WheelShape::cylinder || shape == WheelShape::prism; }

/// The triangles of a wheel about the z axis
TriangleMesh wheel_mesh(WheelShape shape, const WheelBed& bed)
{
    const double radius = radius_of(shape), half = wheel_width / 2;
    if (shape == WheelShape::prism) {
        const double beyond = bed.width / 2 + 2 * bed.R;
        return lathe_mesh({{radius, beyond}, {radius, -beyond}}, 96);
    }
    if (shape == WheelShape::closed_cylinder)
        return lathe_mesh({{0, half}, {radius, half}, {radius, -half}, {0, -half}}, 96);
    std::vector<std::array<double, 2>> profile;
    constexpr int around = 24;
    for (int k = 0; k < around; ++k) {
        const double angle = -2 * std::numbers::pi * k / around;
        profile.push_back({radius - half + half * std::cos(angle), half * std::sin(angle)});
    }
    profile.push_back(profile.front());
    return lathe_mesh(profile, 96);
}

/// The world of a bed, without a wheel
struct Soil {
    World world;
    WheelBed bed;

    Soil(const WheelBed& bed, double friction, double mu_r, Device device)
        : world(options(bed, device), {rock()}), bed(bed)
    {
        world.set_law(0, 0, law(bed, friction, mu_r));
        Boundary b;
        world.add(b);  // floor
        b.axis = {1, 0, 0}, world.add(b);
        b.axis = {-1, 0, 0}, b.r = {bed.length, 0, 0}, world.add(b);
    }

    /// Adds the wheel, at rest with its axis at the height z, and returns its number.
    int add_wheel(WheelShape shape, double z, double mass)
    {
        Boundary b;
        b.r = {start_x, bed.width / 2, z}, b.mass = mass, b.free = {false, false, true};
        if (shape == WheelShape::cylinder) {
            b.shape = Boundary::Shape::cylinder, b.axis = {0, 1, 0}, b.radius = radius_of(shape);
            return world.add(b);
        }
        // The axis of a lathe is z. It is turned to y by -90 degrees about x.
        const double s = std::sqrt(0.5);
        b.shape = Boundary::Shape::mesh, b.axis = {0, 0, 1}, b.p = {s, {-s, 0, 0}};
        return world.add(b, wheel_mesh(shape, bed));
    }

    static WorldOptions options(const WheelBed& bed, Device device)
    {
        WorldOptions o;
        o.low = {-bed.R, 0, -bed.R}, o.high = {bed.length + bed.R, bed.width, 3 * bed.depth};
        o.periodic = {false, true, false};
        o.gravity = {0, 0, -g}, o.h = bed.h, o.device = device;
        return o;
    }

    /// A loose lattice with random displacements
    void fill()
    {
        constexpr double packing = 0.56;
        const double R = bed.R, across = bed.length - 2 * R;
        const int columns = static_cast<int>(across / (2.1 * R)) + 1,
                  rows = std::max(1, static_cast<int>(bed.width / (2.1 * R)));
        const auto count = static_cast<int>(
            std::lround(packing * bed.length * bed.width * bed.depth / sphere_volume(bed.R)));
        Random random(bed.seed);
        const auto in = [&](double most) { return random.number(-most, most); };
        for (int k = 0; k < count; ++k) {
            const int i = k % columns, j = k / columns % rows, layer = k / (columns * rows);
            Particle p;
            p.radius = R;
            p.r.x = std::clamp(R + i * across / (columns - 1) + in(0.03 * R), R, bed.length - R);
            p.r.y = (j + 0.5) * bed.width / rows + in(0.03 * R);
            p.r.z = 1.05 * R + layer * 2.15 * R + in(0.03 * R);
            p.v = {in(0.3), in(0.3), in(0.3)};
            world.add(p);
        }
    }

    void settle(const std::function<void(double)>& progress)
    {
        granular::settle(world,
                         {.what = "the bed",
                          .interval = std::lround(0.02 / bed.h),
                          .longest = longest_settling,
                          .energy = settled_energy},
                         progress);
    }
};

/// Highest point of the bed within 2R of x
double surface(const std::vector<BedSphere>& grains, double x, double R)
{
    double highest = 0;
    for (const BedSphere& s : grains)
        if (std::abs(s.r.x - x) < 2 * R) highest = std::max(highest, s.r.z + R);
    return highest;
}

}  // namespace

const char* name_of(WheelShape shape)
{
    switch (shape) {
        case WheelShape::prism:
            return "prism";
        case WheelShape::closed_cylinder:
            return "cylinder with ends";
        case WheelShape::tyre:
            return "tyre";
        default:
            return "cylinder";
    }
}

BedCase bed_case(const WheelBed& bed)
{
    return {"wheel",
            {{"R", bed.R},
             {"length", bed.length},
             {"width", bed.width},
             {"depth", bed.depth},
             {"h", bed.h},
             {"density", rock().density},
             {"k", bed.k},
             {"gamma", gamma},
             {"mu", bed.settling_mu},
             {"mu_r", settling_mu_r},
             {"g", g},
             {"seed", static_cast<double>(bed.seed)},
             {"settled energy", settled_energy}}};
}

std::vector<Vec3> settled_soil(const WheelBed& bed, const ValidationOptions& options,
                               const std::function<void(double)>& progress)
{
    std::vector<Vec3> grains;
    options.beds.bed(
        bed_case(bed),
        [&] {
            Soil now(bed, bed.settling_mu, settling_mu_r, options.device);
            now.fill();
            now.settle(progress);
            for (const Particle& p : now.world.particles()) grains.push_back(p.r);
        },
        [&](io::Archive& a) { a.list(grains); });
    return grains;
}

void WheelRecord::append(const WheelRecord& other)
{
    const auto add = [&](std::vector<double> WheelRecord::*column) {
        (this->*column).insert((this->*column).end(), (other.*column).begin(), (other.*column).end());
    };
    add(&WheelRecord::t), add(&WheelRecord::pull), add(&WheelRecord::load), add(&WheelRecord::torque),
        add(&WheelRecord::sinkage);
    from = other.from, power += other.power, dissipated += other.dissipated;
}

WheelRecord::Mean WheelRecord::mean(const std::vector<double>& column, double after) const
{
    double n = 0, sum = 0, squares = 0;
    for (std::size_t k = 0; k < t.size(); ++k)
        if (t[k] > after) n += 1, sum += column[k], squares += column[k] * column[k];
    const double value = sum / n;
    return {value, std::sqrt(max_or_nan(0, squares / n - value * value))};
}

WheelRecord drive(const WheelTest& test, const std::vector<Vec3>& soil, const ValidationOptions& options)
{
    const WheelBed& bed = test.bed;
    Soil now(bed, mu, test.mu_r, options.device);
    World& world = now.world;
    for (const Vec3& r : soil) {
        Particle p;
        p.radius = bed.R, p.r = r;
        world.add(p);
    }
    const std::vector<BedSphere> before = equal_spheres(world, bed.R);
    const double radius = radius_of(test.shape), v = omega * radius * (1 - test.slip),
                 scale = is_plane_strain(test.shape) ? wheel_width / bed.width : 1;

    const double lowest =
        first_contact(before, radius, [](const Vec3& r) { return std::abs(r.x - start_x); });
    const int number = now.add_wheel(test.shape, lowest, wheel_load / scale / g);
    world.step(std::lround(resting / bed.h));
    world.boundary(number).v.x = v, world.boundary(number).omega = {0, omega, 0};

    WheelRecord out;
    constexpr long between = 20;  // steps between two evaluations of the loads
    const auto rows = std::lround(test.duration / test.interval),
               loads = std::lround(test.interval / bed.h / static_cast<double>(between));
    const auto end_of = [&](long row) { return static_cast<double>(row + 1) * test.interval; };
    double dissipated = std::nan("");  // before out.from [J]
    out.from = end_of(rows - 1);
    for (long k = 0; k < rows; ++k) {
        if (std::isnan(dissipated) && end_of(k - 1) > (1 - test.averaged) * test.duration - bed.h / 2)
            out.from = end_of(k - 1), dissipated = world.watch().dissipated;
        double pull = 0, load = 0, torque = 0, sinkage = 0;
        for (long i = 0; i < loads; ++i) {
            world.step(between);
            const Wrench w = world.totals().on_boundary[static_cast<std::size_t>(number)];
            const double part = 1 / static_cast<double>(loads);
            pull += part * scale * w.F.x, load += part * scale * w.F.z, torque -= part * scale * w.T.y;
            const Boundary& wheel = world.all_boundaries()[static_cast<std::size_t>(number)];
            if (i % 10 == 0)
                sinkage += (surface(before, wheel.r.x, bed.R) - (wheel.r.z - radius)) /
                           std::ceil(static_cast<double>(loads) / 10);
        }
        out.t.push_back(end_of(k)), out.pull.push_back(pull), out.load.push_back(load);
        out.torque.push_back(torque), out.sinkage.push_back(sinkage);
    }
    out.power = out.mean(out.torque, out.from).value * omega - out.mean(out.pull, out.from).value * v;
    out.dissipated = scale * (world.watch().dissipated - dissipated) / (end_of(rows - 1) - out.from);
    const Boundary& wheel = world.all_boundaries()[static_cast<std::size_t>(number)];
    out.wheel_x = wheel.r.x, out.wheel_z = wheel.r.z;
    for (const Particle& p : world.particles()) out.grains.push_back({p.r.x, p.r.z, p.v.norm()});
    options.include(io::formatted("%s, slip %g, mu_r = %g", name_of(test.shape), test.slip, test.mu_r),
                    world);
    return out;
}

namespace {

/// A test, and the number of beds on which it is made; their seeds follow each other.
struct TestOnBeds {
    WheelTest test;
    int beds;
};

/// The cylinder by slip, some of them without rolling friction; then the meshes
std::vector<TestOnBeds> tests(bool full)
{
    WheelTest test;
    if (full) test.bed.width = 0.12;
    int beds = full ? 4 : 1;
    std::vector<TestOnBeds> all;
    const auto add = [&](const std::vector<double>& slips) {
        for (const double slip : slips) all.push_back({test, beds}), all.back().test.slip = slip;
    };
    add(full ? std::vector{-0.7, -0.5, -0.3, -0.1, 0., 0.1, 0.3, 0.5, 0.7} : std::vector{-0.3, 0., 0.3, 0.7});
    beds = 1, test.mu_r = 0;
    add(full ? std::vector{-0.3, 0., 0.3, 0.7} : std::vector{0.3});
    test.mu_r = WheelTest{}.mu_r, test.shape = WheelShape::prism;
    add({0.3});
    if (full) {
        test.shape = WheelShape::closed_cylinder, test.bed.width = 0.32;
        add({-0.3, 0, 0.3, 0.7});
        test.shape = WheelShape::tyre, test.bed.length = 1.05;
        add({-0.3, 0, 0.3, 0.7});
    }
    return all;
}

struct Measured {
    WheelTest test;
    double pull = 0, load = 0, torque = 0, sinkage = 0, power = 0, dissipated = 0;
};

constexpr double infinite = std::numeric_limits<double>::infinity();

/// Quantities of the tests with one wheel over the slip; NaN if one of the tests has failed
struct OverSlip {
    double pull = infinite, torque = infinite;         ///< smallest increases to the next slip [N, N m]
    double zero = std::nan("");                        ///< slip at which the pull changes its sign
    double sinkage = infinite, least_sunk = infinite;  ///< least sinkage and its slip [m, 1]

    explicit OverSlip(const std::vector<Measured>& of)
    {
        for (std::size_t k = 0; k < of.size(); ++k) {
            const Measured& m = of[k];
            if (const double least = min_or_nan(sinkage, m.sinkage); least != sinkage)
                sinkage = least, least_sunk = std::isnan(least) ? least : m.test.slip;
            if (k == 0) continue;
            const Measured& last = of[k - 1];
            pull = min_or_nan(pull, m.pull - last.pull);
            torque = min_or_nan(torque, m.torque - last.torque);
            if (last.pull < 0 && m.pull >= 0)
                zero = last.test.slip - last.pull * (m.test.slip - last.test.slip) / (m.pull - last.pull);
        }
        if (std::isnan(pull)) zero = pull;
    }
};

std::vector<ValidationCheck> checks(const std::vector<Measured>& all)
{
    const auto of = [&](WheelShape shape, bool rolls = true) {
        std::vector<Measured> some;
        for (const Measured& m : all)
            if (m.test.shape == shape && (m.test.mu_r == 0) != rolls) some.push_back(m);
        return some;
    };
    const auto at = [](const std::vector<Measured>& some, double slip) {
        return *std::find_if(some.begin(), some.end(),
                             [&](const Measured& m) { return m.test.slip == slip; });
    };
    const std::vector<Measured> cylinder = of(WheelShape::cylinder);
    const OverSlip by_slip(cylinder);
    double load = 0, power = infinite, dissipated = infinite;
    for (const Measured& m : all) {
        load = max_or_nan(load, std::abs(m.load / wheel_load - 1));
        power = min_or_nan(power, m.power), dissipated = min_or_nan(dissipated, m.dissipated);
    }
    const Measured rolling = at(cylinder, 0.3), sliding = at(of(WheelShape::cylinder, false), 0.3),
                   prism = at(of(WheelShape::prism), 0.3);
    std::vector<ValidationCheck> out = {
        {"least increase of the pull to the next slip [N]", by_slip.pull, 0, no_bound},
        {"slip at which the pull changes its sign", by_slip.zero, -0.1, 0.3},
        {"least increase of the torque to the next slip [N m]", by_slip.torque, 0, no_bound},
        {"slip of the least sinkage", by_slip.least_sunk, -0.3, 0.3},
        {"sinkage at slip 0.7 over the least", cylinder.back().sinkage / by_slip.sinkage, 1, no_bound},
        {"vertical load over the weight of the wheel - 1, largest", load, 0, 0.02},
        {"least torque omega - pull v [W]", power, 0, no_bound},
        {"least dissipation of the contacts [W]", dissipated, 0, no_bound},
        {"sinkage without rolling friction over that with, slip 0.3", sliding.sinkage / rolling.sinkage, 1,
         no_bound},
        {"pull without rolling friction minus that with, slip 0.3 [N]", sliding.pull - rolling.pull,
         -no_bound, 0},
        {"torque of the mesh over that of the cylinder - 1, plane strain, slip 0.3",
         prism.torque / rolling.torque - 1, -0.1, 0.1}};
    for (const WheelShape shape : {WheelShape::closed_cylinder, WheelShape::tyre})
        if (const std::vector<Measured> mesh = of(shape); !mesh.empty()) {
            const OverSlip over_slip(mesh);
            const std::string name = name_of(shape);
            out.push_back(
                {name + ": least increase of the pull to the next slip [N]", over_slip.pull, 0, no_bound});
            out.push_back({name + ": least increase of the torque to the next slip [N m]", over_slip.torque,
                           0, no_bound});
            if (shape == WheelShape::tyre)
                out.push_back(
                    {name + ": slip at which the pull changes its sign", over_slip.zero, -0.1, 0.3});
        }
    return out;
}

ValidationResult run(const ValidationOptions& options)
{
    const std::vector<TestOnBeds> all = tests(options.full);
    double parts = 0, done = 0;
    for (const TestOnBeds& t : all) parts += t.beds;
    if (options.full)
        options.announce(io::formatted("%.0f wheel tests, more than an hour of CPU time", parts));

    ValidationTable table{"study",
                          {"wheel", "slip", "mu_r", "beds", "pull", "pull_deviation", "torque",
                           "torque_deviation", "sinkage", "sinkage_deviation", "load", "power", "dissipated"},
                          {}},
        motion{"motion", {"wheel", "slip", "mu_r", "t", "pull", "load", "torque", "sinkage"}, {}},
        grains{"grains", {"wheel", "slip", "mu_r", "x", "z", "speed", "wheel_x", "wheel_z"}, {}};
    std::vector<WheelTest> drives;  // of each test on each of its beds
    for (const auto& [test, beds] : all)
        for (int n = 0; n < beds; ++n) drives.push_back(test), drives.back().bed.seed += n;
    std::vector<WheelRecord> records(drives.size());
    std::map<std::string, std::vector<Vec3>> soils;  // by the hash of their case
    const auto compute = [&](long k) {
        const WheelTest& test = drives[static_cast<std::size_t>(k)];
        const auto [soil, is_new] = soils.try_emplace(bed_case(test.bed).hash());
        if (is_new)
            soil->second = settled_soil(test.bed, options,
                                        [&](double share) { options.progress((done + share / 2) / parts); });
        records[static_cast<std::size_t>(k)] = drive(test, soil->second, options);
        options.progress(++done / parts);
    };
    options.kept.parts(static_cast<long>(drives.size()), compute, [&](io::Archive& a, long k) {
        WheelRecord& r = records[static_cast<std::size_t>(k)];
        for (auto* column : {&r.t, &r.pull, &r.load, &r.torque, &r.sinkage}) a.list(*column);
        a.list(r.grains), a.value(r.from), a.value(r.power), a.value(r.dissipated), a.value(r.wheel_x),
            a.value(r.wheel_z);
    });
    std::vector<Measured> measured;
    auto record = records.cbegin();
    for (const auto& [test, beds] : all) {
        const char* wheel = name_of(test.shape);
        WheelRecord pooled;  // the records of all beds, one after the other
        for (int n = 0; n < beds; ++n, ++record) {
            const WheelRecord& r = *record;
            pooled.append(r);
            if (n > 0) continue;
            for (std::size_t k = 0; k < r.t.size(); ++k)
                motion.rows.push_back(
                    {wheel, test.slip, test.mu_r, r.t[k], r.pull[k], r.load[k], r.torque[k], r.sinkage[k]});
            for (const WheelRecord::Grain& p : r.grains)
                grains.rows.push_back({wheel, test.slip, test.mu_r, p.x, p.z, p.speed, r.wheel_x, r.wheel_z});
        }
        const double count = beds;
        const WheelRecord::Mean pull = pooled.mean(pooled.pull, pooled.from),
                                torque = pooled.mean(pooled.torque, pooled.from),
                                sinkage = pooled.mean(pooled.sinkage, pooled.from),
                                load = pooled.mean(pooled.load, pooled.from);
        const double power = pooled.power / count, dissipated = pooled.dissipated / count;
        table.rows.push_back({wheel, test.slip, test.mu_r, count, pull.value, pull.deviation, torque.value,
                              torque.deviation, sinkage.value, sinkage.deviation, load.value, power,
                              dissipated});
        measured.push_back({test, pull.value, load.value, torque.value, sinkage.value, power, dissipated});
    }
    return {{table, motion, grains}, checks(measured)};
}

const bool registered_wheel = io::Registry<Validation>::add(
    {.name = "wheel",
     .description = "pull, torque and sinkage of a wheel on a bed of grains over the slip (Figs. 7.21, 7.23)",
     .run = run,
     .independent_parts = true});

}  // namespace

}  // namespace hilda::granular
