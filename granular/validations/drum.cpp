// SPDX-License-Identifier: GPL-3.0-or-later
/// Flow of grains in a rotating drum (Fang 2022, Sec. 7.2.5).
///
/// The shell of the drum is a layer of grains that are attached to it, as in the author's program (Fang,
/// repository chronoGranularValidationTests, 2021); a smooth shell does not lift the grains. The end walls
/// are planes that rotate with the drum. The regime of the flow depends on the Froude number
///
///     Fr = ω² radius/g
///
/// Quantities, each averaged over the samples of the last turns. A grain falls freely by a tenth of the
/// radius of the drum in four intervals between samples.
///
/// - Surface: the solid fraction is averaged in cells of edge 2R in x and z. The surface of a column is the
///   lowest height above its densest part where the fraction falls below 0.3, by linear interpolation.
/// - Angle: of the straight line by least squares through the surface over |x| < 0.4 radius.
/// - Airborne: grains in a free flight over four intervals or more. In an interval τ of a free flight the
///   velocity changes by g τ, within 5 %; a contact changes it otherwise.
/// - Covered: the rim has 36 sectors of 10°. A sector is covered if a grain is there that touches the shell
///   or is less than a radius apart, ρ > radius - 3R, with a velocity that differs by less than 20 % from
///   that of the drum.
/// - Invariance: with E ~ g and h ~ 1/ω the equations of motion in units of the radius, of 1/ω and of the
///   mass of a grain depend on Fr only.

#include "granular/validations/drum.hpp"

#include "granular/backend/split_mix.hpp"
#include "granular/validations/settling.hpp"
#include "granular/validations/straight_line.hpp"
#include "io/message.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace hilda::granular {

namespace {

constexpr double restitution = 0.97, restitution_wall = 0.82, mu = 0.16, mu_wall = 0.45, mu_r = 0.09;
constexpr double settled_energy = 1e-2;  ///< largest kinetic energy per grain [m g R]
constexpr double longest_settling = 3;   // [s]
constexpr double none = std::numeric_limits<double>::quiet_NaN();

enum MaterialNumber { grain, wall };

Material glass(const Drum& d) { return {"glass", 2500, d.E, 0.24}; }

/// Volume of a grain [m³]
double of_grain(const Drum& d) { return sphere_volume(d.R); }

PairLaw law(const Drum& d, double e, double friction, double slow)
{
    PairLaw l = hertz_mindlin(glass(d), e, friction);
    l.rolling = ConstantTorque::with_half_radius(mu_r, slow);
    return l;
}

/// The world of a drum with its shell, at rest
struct RotatingDrum {
    World world;
    int shell = 0, front = 0, back = 0;
    std::uint32_t first = 0;  ///< id of the first grain that is not of the shell

    /// `slow`: angular velocity below which the rolling resistance is regularised [rad/s]
    RotatingDrum(const Drum& d, double slow, Device device) : world(options(d, device), {glass(d), glass(d)})
    {
        world.set_law(grain, grain, law(d, restitution, mu, slow));
        world.set_law(grain, wall, law(d, restitution_wall, mu_wall, slow));
        world.set_law(wall, wall, law(d, restitution_wall, mu_wall, slow));  // of the shell and the end walls
        Boundary b;
        b.material = wall;
        b.axis = {0, 1, 0}, b.r = {0, -d.width / 2, 0}, front = world.add(b);
        b.axis = {0, -1, 0}, b.r = {0, d.width / 2, 0}, back = world.add(b);
        // The cylinder carries the shell grains and is behind them.
        b.axis = {0, 1, 0}, b.r = {0, 0, 0}, b.shape = Boundary::Shape::cylinder, b.inside = 1;
        b.radius = d.radius + 2 * d.R, shell = world.add(b);

        const int around = static_cast<int>(std::numbers::pi * d.radius / d.R),
                  rings = static_cast<int>(std::lround(d.width / (2 * d.R)));
        for (int j = 0; j < rings; ++j)
            for (int i = 0; i < around; ++i) {
                const double angle = 2 * std::numbers::pi * (i + 0.5 * (j % 2)) / around;
                Particle p;
                p.radius = d.R, p.material = wall, p.attached_to = shell;
                p.r = {d.radius * std::cos(angle), (j + 0.5) * d.width / rings - d.width / 2,
                       d.radius * std::sin(angle)};
                first = world.add(p) + 1;
            }
    }

    static WorldOptions options(const Drum& d, Device device)
    {
        const double side = d.radius + 1.5 * d.R, half = d.width / 2 + d.R / 2;
        WorldOptions o;
        o.low = {-side, -half, -side}, o.high = {side, half, side};
        o.gravity = {0, 0, -d.g}, o.h = d.h, o.device = device;
        return o;
    }

    void rotate(double omega)
    {
        for (const int b : {shell, front, back}) world.boundary(b).omega = {0, omega, 0};
    }

    std::vector<Particle> grains() const
    {
        std::vector<Particle> all;
        world.each_particle([&](const Particle& p) {
            if (p.id >= first) all.push_back(p);
        });
        return all;
    }
};

/// A lattice with random displacements and velocities in the whole drum
std::vector<Particle> lattice(const Drum& d)
{
    const double spacing = 2.05 * d.R, across = d.width - 2 * d.R, most = d.radius - 2.1 * d.R;
    const int n = static_cast<int>(most / spacing), rows = static_cast<int>(across / spacing) + 1;
    Random random(1);
    std::vector<Particle> all;
    for (int k = -n; k <= n; ++k)
        for (int i = -n; i <= n; ++i)
            for (int j = 0; j < rows; ++j) {
                const auto in = [&](double range) { return random.number(-range, range); };
                Particle p;
                p.radius = d.R;
                p.r = {
                    i * spacing + in(0.02 * d.R),
                    std::clamp((rows > 1 ? j * across / (rows - 1) : across / 2) - across / 2 + in(0.3 * d.R),
                               -across / 2, across / 2),
                    k * spacing + in(0.02 * d.R)};
                p.v = {in(0.05), in(0.05), in(0.05)};
                if (std::hypot(p.r.x, p.r.z) < most) all.push_back(p);
            }
    return all;
}

/// Sums over the samples of a run
class Samples {
public:
    static constexpr int long_flight = 4;  ///< intervals

    Samples(const DrumRun& run, std::size_t grains) : of(run), d(run.drum), flight(grains)
    {
        side = static_cast<int>(std::ceil(d.radius / (2 * d.R)));
        volume.assign(index(2 * side, 0), 0);
    }

    /// `before`: the grains a time tau earlier, in the same order
    void add(const std::vector<Particle>& grains, const std::vector<Particle>& before, double tau)
    {
        const double omega = of.omega(), n = static_cast<double>(grains.size());
        std::array<bool, 36> sector{};
        for (std::size_t k = 0; k < grains.size(); ++k) {
            const Particle& p = grains[k];
            mass_x += p.r.x / n, mass_z += p.r.z / n;
            const Vec3 gain = p.v - before[k].v + Vec3{0, 0, d.g * tau};
            const bool falls = gain.norm() < 0.05 * d.g * tau;
            flight[k] = falls ? flight[k] + 1 : 0;
            if (flight[k] >= long_flight) airborne += (flight[k] == long_flight ? long_flight : 1) / n;
            const int i = cell(p.r.x), j = cell(p.r.z);
            if (i >= 0 && j >= 0 && i < 2 * side && j < 2 * side) volume[index(j, i)] += of_grain(d);
            const double rho = std::hypot(p.r.x, p.r.z);
            const Vec3 drum{omega * p.r.z, 0, -omega * p.r.x};
            if (rho > d.radius - 3 * d.R && (p.v - drum).norm() < 0.2 * omega * rho) {
                const double turn = std::atan2(p.r.z, p.r.x) / (2 * std::numbers::pi) + 0.5;
                sector[std::min<std::size_t>(static_cast<std::size_t>(36 * turn), 35)] = true;
            }
        }
        covered = std::min(covered, static_cast<double>(std::count(sector.begin(), sector.end(), true)) / 36);
        ++count;
    }

    DrumFlow result() const
    {
        DrumFlow out;
        out.centre_angle = std::atan2(-mass_x, -mass_z) * 180 / std::numbers::pi;
        out.airborne = airborne / count, out.covered = covered;
        for (int i = 0; i < 2 * side; ++i)
            out.x.push_back((i + 0.5 - side) * 2 * d.R), out.surface.push_back(surface(i));
        out.angle = surface_angle(out.x, out.surface, d.radius);
        return out;
    }

private:
    int cell(double x) const { return static_cast<int>(std::floor(x / (2 * d.R))) + side; }

    /// Of a cell in row j and column i
    std::size_t index(int j, int i) const
    {
        return static_cast<std::size_t>(j) * 2 * static_cast<std::size_t>(side) + static_cast<std::size_t>(i);
    }

    double surface(int i) const
    {
        constexpr double limit = 0.3;
        const auto fraction = [&](int j) { return volume[index(j, i)] / (count * 4 * d.R * d.R * d.width); };
        int densest = 0;
        for (int j = 0; j < 2 * side; ++j)
            if (fraction(j) > fraction(densest)) densest = j;
        if (fraction(densest) < limit) return none;
        for (int j = densest; j + 1 < 2 * side; ++j)
            if (fraction(j + 1) < limit)
                return (j + 0.5 - side + (fraction(j) - limit) / (fraction(j) - fraction(j + 1))) * 2 * d.R;
        return none;
    }

    const DrumRun& of;
    const Drum& d;
    std::vector<int> flight;     ///< intervals of free flight up to now, of each grain
    int side = 0;                ///< cells from the axis to the shell
    std::vector<double> volume;  ///< of the grains in each cell, summed over the samples [m³]
    double count = 0, mass_x = 0, mass_z = 0, airborne = 0, covered = 1;
};

}  // namespace

double DrumRun::omega() const { return std::sqrt(froude * drum.g / drum.radius); }

double surface_angle(const std::vector<double>& x, const std::vector<double>& surface, double radius)
{
    std::vector<double> of_x, of_z;
    for (std::size_t k = 0; k < x.size(); ++k)
        if (std::abs(x[k]) < 0.4 * radius && std::isfinite(surface[k]))
            of_x.push_back(x[k]), of_z.push_back(surface[k]);
    if (of_x.size() < 3) return none;
    return -std::atan(StraightLine(of_x, of_z).b) * 180 / std::numbers::pi;
}

BedCase bed_case(const Drum& d)
{
    return {"drum",
            {{"R", d.R},
             {"radius", d.radius},
             {"width", d.width},
             {"h", d.h},
             {"density", glass(d).density},
             {"E", d.E},
             {"nu", glass(d).nu},
             {"restitution", restitution},
             {"mu", mu},
             {"restitution of walls", restitution_wall},
             {"mu of walls", mu_wall},
             {"mu_r", mu_r},
             {"g", d.g},
             {"settled energy", settled_energy}}};
}

std::vector<Vec3> settled_grains(const Drum& d, const ValidationOptions& options,
                                 const std::function<void(double)>& progress)
{
    std::vector<Vec3> centres;
    const auto settle = [&] {
        RotatingDrum now(d, 1e-4, options.device);
        World& world = now.world;
        const std::vector<Particle> start = lattice(d);
        for (const Particle& p : start) world.add(p);
        granular::settle(world,
                         {.what = "the bed of the drum",
                          .interval = std::lround(0.01 / d.h),
                          .longest = longest_settling,
                          .energy = settled_energy},
                         progress);
        for (const Particle& p : now.grains())
            if (p.r.z < 0) centres.push_back(p.r);
    };
    options.beds.bed(bed_case(d), settle, [&](io::Archive& a) { a.list(centres); });
    return centres;
}

DrumFlow flow(const DrumRun& run, const std::vector<Vec3>& centres, const ValidationOptions& options)
{
    const Drum& d = run.drum;
    const double omega = run.omega();
    RotatingDrum now(d, 1e-3 * omega, options.device);
    World& world = now.world;
    for (const Vec3& r : centres) {
        Particle p;
        p.radius = d.R, p.r = r;
        world.add(p);
    }
    now.rotate(omega);

    const long interval = std::lround(std::sqrt(0.2 * d.radius / d.g) / Samples::long_flight / d.h);
    const double tau = static_cast<double>(interval) * d.h, turn = 2 * std::numbers::pi / omega;
    const auto samples = static_cast<long>(std::ceil(run.averaged * turn / tau)),
               all = std::max(samples, std::lround(run.turns * turn / tau));
    world.step((all - samples) * interval);
    std::vector<Particle> before = now.grains();
    Samples sums(run, before.size());
    for (long k = 0; k < samples; ++k) {
        world.step(interval);
        std::vector<Particle> grains = now.grains();
        sums.add(grains, before, tau);
        before.swap(grains);
    }
    DrumFlow out = sums.result();
    for (const Particle& p : before) {
        out.centres.push_back(p.r);
        if (std::abs(p.r.y) < d.R) out.slice.push_back({p.r.x, p.r.z, p.v.norm() / (omega * d.radius)});
    }
    options.include(io::formatted("Fr = %g, g = %g m/s^2, E = %g Pa", run.froude, d.g, d.E), world);
    return out;
}

namespace {

/// A run, in units in which ω is an integer multiple of that with g = 9.81 m/s²
struct ScaledRun {
    DrumRun of;
    int scale = 1;  ///< ω over that of g = 9.81 m/s²
};

/// Runs by the Froude number; then one with four times the gravity and E, and twice ω
std::vector<ScaledRun> runs(bool full)
{
    Drum d;
    if (!full) d.R = 1e-3, d.width = 6e-3, d.h *= 2;
    std::vector<ScaledRun> all;
    const auto add = [&](double froude, double turns, double averaged) {
        all.push_back({{d, froude, turns, averaged}});
    };
    if (full) add(1e-3, 0.25, 0.125);
    add(0.01, 0.5, 0.25);
    add(0.05, 0.75, 0.25);
    add(0.1, 0.75, 0.25);
    add(0.5, 2, 0.5);
    if (full) add(1, 2, 0.5);
    add(1.5, 2, 0.5);
    d.g *= 4, d.E *= 4, d.h /= 2;
    add(0.1, 0.75, 0.25);
    all.back().scale = 2;
    return all;
}

struct Measured {
    ScaledRun run;
    DrumFlow flow;
};

/// Largest distance of the centres of the grains of two runs [2R]
double distance(const DrumFlow& a, const DrumFlow& b, double R)
{
    double largest = a.centres.size() == b.centres.size() ? 0 : none;
    for (std::size_t k = 0; k < std::min(a.centres.size(), b.centres.size()); ++k)
        largest = max_or_nan(largest, (a.centres[k] - b.centres[k]).norm() / (2 * R));
    return largest;
}

std::vector<ValidationCheck> checks(const std::vector<Measured>& all)
{
    std::vector<ValidationCheck> out;
    const Measured *flat = nullptr, *last = nullptr;
    for (const Measured& m : all) {
        const double Fr = m.run.of.froude;
        const std::string at = io::formatted("Fr = %g", Fr);
        if (m.run.scale != 1) {
            for (const Measured& same : all)
                if (same.run.scale == 1 && same.run.of.froude == Fr) {
                    const double R = m.run.of.drum.R;
                    out.push_back({at + ", four times g and twice omega: angle over the same with g",
                                   m.flow.angle / same.flow.angle, 1 - 1e-3, 1 + 1e-3});
                    out.push_back({at + ", four times g and twice omega: largest distance of a grain [2R]",
                                   distance(m.flow, same.flow, R), 0, 1e-3});
                }
            continue;
        }
        if (Fr < 0.06) out.push_back({"airborne share at " + at, m.flow.airborne, 0, 2e-3});
        if (Fr == 0.5) {
            out.push_back({"airborne share at " + at, m.flow.airborne, 0.03, 1});
            out.push_back({"least covered share of the rim at " + at, m.flow.covered, 0, 0.95});
        }
        if (Fr == 1.5) out.push_back({"least covered share of the rim at " + at, m.flow.covered, 1, 1});
        if (Fr < 0.2) {
            if (flat != nullptr)
                out.push_back(
                    {io::formatted("angle of the surface above that at Fr = %g, ", flat->run.of.froude) + at,
                     m.flow.angle - flat->flow.angle, 0, no_bound});
            flat = &m;
        }
        if (Fr < 0.6) {
            if (last != nullptr)
                out.push_back({io::formatted("angle of the centre of mass above that at Fr = %g, ",
                                             last->run.of.froude) +
                                   at,
                               m.flow.centre_angle - last->flow.centre_angle, 0, no_bound});
            last = &m;
        }
    }
    return out;
}

ValidationResult run(const ValidationOptions& options)
{
    const std::vector<ScaledRun> all = runs(options.full);
    if (options.full)
        options.announce(
            io::formatted("%zu runs with 1.1e10 particle-steps, about 15 minutes of CPU time in the "
                          "preset native",
                          all.size()));
    double done = 0;
    const double parts = static_cast<double>(all.size()) + 1;
    std::vector<Vec3> grains;
    std::vector<DrumFlow> flows(all.size());
    const auto compute = [&](long k) {
        if (grains.empty()) {
            grains = settled_grains(all.front().of.drum, options,
                                    [&](double share) { options.progress(share / parts); });
            options.progress(++done / parts);
        }
        flows[static_cast<std::size_t>(k)] = flow(all[static_cast<std::size_t>(k)].of, grains, options);
        options.progress(++done / parts);
    };
    options.kept.parts(static_cast<long>(all.size()), compute, [&](io::Archive& a, long k) {
        DrumFlow& f = flows[static_cast<std::size_t>(k)];
        a.value(f.angle), a.value(f.centre_angle), a.value(f.airborne), a.value(f.covered);
        a.list(f.x), a.list(f.surface), a.list(f.slice), a.list(f.centres);
    });
    ValidationTable table{
        "study", {"froude", "g", "omega", "R", "turns", "angle", "centre_angle", "airborne", "covered"}, {}},
        surface{"surface", {"froude", "g", "x", "z"}, {}},
        slice{"grains", {"froude", "g", "x", "z", "speed"}, {}};
    std::vector<Measured> measured;
    for (std::size_t n = 0; n < all.size(); ++n) {
        const ScaledRun& r = all[n];
        const DrumFlow& f = flows[n];
        const double Fr = r.of.froude, g = r.of.drum.g;
        table.rows.push_back(
            {Fr, g, r.of.omega(), r.of.drum.R, r.of.turns, f.angle, f.centre_angle, f.airborne, f.covered});
        for (std::size_t k = 0; k < f.x.size(); ++k)
            if (std::isfinite(f.surface[k])) surface.rows.push_back({Fr, g, f.x[k], f.surface[k]});
        for (const DrumFlow::SliceGrain& p : f.slice) slice.rows.push_back({Fr, g, p.x, p.z, p.speed});
        measured.push_back({r, f});
    }
    return {{table, surface, slice}, checks(measured)};
}

const bool registered_drum = io::Registry<Validation>::add(
    {.name = "drum",
     .description = "flow of grains in a rotating drum over the Froude number (Fig. 7.19)",
     .run = run,
     .independent_parts = true});

}  // namespace

}  // namespace hilda::granular
