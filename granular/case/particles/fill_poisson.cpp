// SPDX-License-Identifier: GPL-3.0-or-later
/// Fill poisson: random particles without contact.
#include "granular/case/particles/fill.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

namespace {

/// Bridson's algorithm (2007): 30 candidates around each point, at a distance between one and two spacings. A
/// background grid of cells with one point each limits the distance checks to 5³ cells.
std::vector<Vec3> poisson_centres(const FillSpec& f, const Vec3& low, const Vec3& high, Random& random)
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
    // from bottom to top, so that max_count keeps the lowest ones
    std::sort(all.begin(), all.end(), [](const Vec3& a, const Vec3& b) {
        return std::tuple(a.z, a.y, a.x) < std::tuple(b.z, b.y, b.x);
    });
    return all;
}

/// Bridson's algorithm generates about 0.58 particles per cube of the spacing. max_count is ignored, because
/// all positions are generated first.
double estimated_poisson(const FillSpec& f, const Vec3& size)
{
    const auto n = [&](double length) { return length / f.spacing + 0.4; };
    return 0.58 * n(size.x) * n(size.y) * n(size.z);
}

const bool registered_fill_poisson = io::Registry<FillType>::add(
    {.name = "poisson",
     .schema = {.description =
                    "Random positions with a minimum distance (Bridson 2007), sorted from the bottom.",
                .examples = {R"("low": [0, 0, 0], "high": [0.03, 0.02, 0.028], "radius": 0.001,
                                "least_radius": 8e-4, "spacing": 1.02)"},
                .rest = rest_of_filled_box},
     .read = read_filled_box,
     .centres = poisson_centres,
     .estimated_count = estimated_poisson});

}  // namespace

}  // namespace hilda::granular
