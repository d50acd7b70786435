// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/fill.hpp"

#include "granular/case/split_mix.hpp"
#include "io/archive.hpp"
#include "io/files.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

namespace {

class Random {
public:
    explicit Random(std::uint64_t seed) : state(seed) {}
    double number()  ///< uniform in [0, 1)
    {
        return static_cast<double>(SplitMix::mixed(state += SplitMix::step) >> 11) * 0x1p-53;
    }
    double number(double low, double high) { return low + (high - low) * number(); }
    Vec3 direction()
    {
        const double z = number(-1, 1), angle = number(0, 2 * M_PI), across = std::sqrt(1 - z * z);
        return {across * std::cos(angle), across * std::sin(angle), z};
    }

private:
    std::uint64_t state;
};

/// Distances of centres within a row, of rows and of layers [m]
Vec3 distances(const FillSpec& f)
{
    const double a = f.spacing;
    if (f.type != FillSpec::Type::hcp) return {a, a, a};
    return {a, a * std::sqrt(3.) / 2, a * std::sqrt(2. / 3)};
}

/// Lattice points between low and high, with rows along x and layers along z
std::vector<Vec3> lattice(const FillSpec& f, const Vec3& low, const Vec3& high)
{
    const bool hcp = f.type == FillSpec::Type::hcp;
    const auto [a, row, layer] = distances(f);
    std::vector<Vec3> all;
    for (int k = 0; low.z + k * layer <= high.z; ++k)
        for (int j = 0;; ++j) {
            const double y = low.y + j * row + (hcp && k % 2 == 1 ? row / 3 : 0);
            if (!(y <= high.y)) break;
            for (int i = 0;; ++i) {
                const double x = low.x + i * a + (hcp && (j + k) % 2 == 1 ? a / 2 : 0);
                if (!(x <= high.x)) break;
                if (f.max_count > 0 && all.size() == f.max_count) return all;
                all.push_back({x, y, low.z + k * layer});
            }
        }
    return all;
}

/// Bridson's algorithm (2007): 30 candidates around each point, at a distance between one and two spacings. A
/// background grid of cells with one point each limits the distance checks to 5³ cells.
std::vector<Vec3> poisson(const FillSpec& f, const Vec3& low, const Vec3& high, Random& random)
{
    const double cell = f.spacing / std::sqrt(3.);
    const auto cells = [&](double length) { return static_cast<long>(length / cell) + 1; };
    const long nx = cells(high.x - low.x), ny = cells(high.y - low.y), nz = cells(high.z - low.z);
    constexpr double most_cells = 4e8;
    if (static_cast<double>(nx) * static_cast<double>(ny) * static_cast<double>(nz) > most_cells)
        throw io::InvalidInput(
            "the box must not have more than 4e8 cells of spacing/sqrt(3); increase the spacing or split the "
            "box");
    std::vector<std::int32_t> in(static_cast<std::size_t>(nx * ny * nz), -1);
    std::vector<Vec3> all;
    const auto index = [&](const Vec3& r, long& x, long& y, long& z) {
        x = static_cast<long>((r.x - low.x) / cell), y = static_cast<long>((r.y - low.y) / cell),
        z = static_cast<long>((r.z - low.z) / cell);
    };
    const auto put = [&](const Vec3& r) {
        if (!(r.x >= low.x && r.x <= high.x && r.y >= low.y && r.y <= high.y && r.z >= low.z &&
              r.z <= high.z))
            return false;
        long x = 0, y = 0, z = 0;
        index(r, x, y, z);
        for (long c = std::max(0L, z - 2); c <= std::min(nz - 1, z + 2); ++c)
            for (long b = std::max(0L, y - 2); b <= std::min(ny - 1, y + 2); ++b)
                for (long a = std::max(0L, x - 2); a <= std::min(nx - 1, x + 2); ++a)
                    if (const std::int32_t other = in[static_cast<std::size_t>((c * ny + b) * nx + a)];
                        other >= 0)
                        if ((all[static_cast<std::size_t>(other)] - r).norm() < f.spacing) return false;
        in[static_cast<std::size_t>((z * ny + y) * nx + x)] = static_cast<std::int32_t>(all.size());
        all.push_back(r);
        return true;
    };
    put({random.number(low.x, high.x), random.number(low.y, high.y), random.number(low.z, high.z)});
    constexpr int tries = 30;
    for (std::size_t k = 0; k < all.size(); ++k)  // NOLINT(modernize-loop-convert): put() appends to the list
        for (int n = 0; n < tries; ++n)
            put(all[k] + random.number(f.spacing, 2 * f.spacing) * random.direction());
    return all;
}

FillSpec read_table(ObjectReader& o)
{
    FillSpec f;
    f.type = FillSpec::Type::csv;
    const std::string file = o.text("file");
    try {
        const std::string text = io::read_file(file, std::size_t{1} << 36);
        f.particles = particles_of_csv(text, file);
        f.checksum = io::checksum(text.data(), text.size());
    } catch (const io::IoError& e) {
        o.fail("file", e.what());
    } catch (const io::InvalidInput& e) {
        o.fail("file", e.what());
    }
    for (const Particle& p : f.particles) f.radius = std::max(f.radius, p.radius);
    return f;
}

}  // namespace

FillSpec read_fill(ObjectReader& o)
{
    FillSpec f;
    const std::string type = o.one_of("type", {"lattice", "hcp", "poisson", "csv"});
    if (type == "csv") return read_table(o);
    f.type = type == "lattice" ? FillSpec::Type::lattice
             : type == "hcp"   ? FillSpec::Type::hcp
                               : FillSpec::Type::poisson;
    f.low = o.vec3("low"), f.high = o.vec3("high");
    f.radius = o.positive("radius");
    f.least_radius = o.number("least_radius", f.radius);
    if (!(f.least_radius > 0 && f.least_radius <= f.radius))
        o.fail("least_radius", "least_radius must be positive and not greater than radius, got " +
                                   io::shortest(f.least_radius));
    const double spacing = o.number("spacing", 1.05);
    if (!(spacing >= 1))
        o.fail("spacing", "spacing must be at least 1 diameter, got " + io::shortest(spacing));
    f.spacing = 2 * f.radius * spacing;
    f.jitter = o.fraction("jitter", 0);
    f.max_count = static_cast<std::size_t>(o.count("count", 0));
    f.seed = static_cast<std::uint64_t>(o.count("seed", 1));
    f.v = o.vec3("v", Vec3{0, 0, 0});
    f.random_v = o.not_negative("random_v", 0);
    for (const auto& [low, high, axis] :
         {std::tuple{f.low.x, f.high.x, 0u}, {f.low.y, f.high.y, 1u}, {f.low.z, f.high.z, 2u}})
        if (!(high - low >= 2 * f.radius))
            o.fail("high", axis,
                   "the box must be at least a diameter wide, got high = " + io::shortest(high));
    return f;
}

double estimated_count(const FillSpec& f)
{
    if (f.type == FillSpec::Type::csv) return static_cast<double>(f.particles.size());
    const Vec3 size = f.high - f.low - 2 * Vec3{f.radius, f.radius, f.radius}, a = distances(f);
    const Vec3 n{size.x / a.x, size.y / a.y, size.z / a.z};
    // Bridson's algorithm generates about 0.58 particles per cube of the spacing
    if (f.type == FillSpec::Type::poisson) return 0.58 * (n.x + 0.4) * (n.y + 0.4) * (n.z + 0.4);
    const double all = (std::floor(n.x) + 1) * (std::floor(n.y) + 1) * (std::floor(n.z) + 1);
    return f.max_count > 0 ? std::min(all, static_cast<double>(f.max_count)) : all;
}

std::vector<Particle> fill(const FillSpec& f)
{
    if (f.type == FillSpec::Type::csv) {
        std::vector<Particle> all = f.particles;
        for (Particle& p : all) {
            p.replica = f.replica;
            if (f.material >= 0) p.material = f.material;
        }
        return all;
    }
    const Vec3 margin{f.radius, f.radius, f.radius}, low = f.low + margin, high = f.high - margin;
    Random random(f.seed);
    std::vector<Vec3> places =
        f.type == FillSpec::Type::poisson ? poisson(f, low, high, random) : lattice(f, low, high);
    if (f.type == FillSpec::Type::poisson)  // from bottom to top, so that max_count keeps the lowest ones
        std::sort(places.begin(), places.end(), [](const Vec3& a, const Vec3& b) {
            return std::tuple(a.z, a.y, a.x) < std::tuple(b.z, b.y, b.x);
        });
    if (f.max_count > 0 && places.size() > f.max_count) places.resize(f.max_count);
    const double free = f.jitter * (f.spacing / 2 - f.radius) / std::sqrt(3.);
    std::vector<Particle> all;
    all.reserve(places.size());
    for (const Vec3& r : places) {
        Particle p;
        p.radius = random.number(f.least_radius, f.radius);
        p.material = f.material, p.replica = f.replica;
        p.r = r + Vec3{random.number(-free, free), random.number(-free, free), random.number(-free, free)};
        p.r = {std::clamp(p.r.x, low.x, high.x), std::clamp(p.r.y, low.y, high.y),
               std::clamp(p.r.z, low.z, high.z)};
        p.v = f.v + f.random_v * random.direction();
        all.push_back(p);
    }
    return all;
}

}  // namespace hilda::granular
