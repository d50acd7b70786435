// SPDX-License-Identifier: GPL-3.0-or-later
/// Fills lattice and hcp: particles on a simple cubic or a hexagonal lattice.
#include "granular/case/particles/fill.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

namespace {

/// Distances of centres within a row, of rows and of layers [m]. hcp is close-packed if the spacing is one
/// diameter.
Vec3 distances(const FillSpec& f, bool hcp)
{
    const double a = f.spacing;
    if (!hcp) return {a, a, a};
    return {a, a * std::sqrt(3.) / 2, a * std::sqrt(2. / 3)};
}

/// Lattice points between low and high, with rows along x and layers along z
template <bool hcp>
std::vector<Vec3> centres(const FillSpec& f, const Vec3& low, const Vec3& high, Random&)
{
    const auto [a, row, layer] = distances(f, hcp);
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

template <bool hcp>
double estimated(const FillSpec& f, const Vec3& size)
{
    const Vec3 a = distances(f, hcp);
    const double all =
        (std::floor(size.x / a.x) + 1) * (std::floor(size.y / a.y) + 1) * (std::floor(size.z / a.z) + 1);
    return f.max_count > 0 ? std::min(all, static_cast<double>(f.max_count)) : all;
}

const std::string example = R"("low": [0, 0, 0], "high": [0.03, 0.02, 0.03], "radius": 0.001, "jitter": 0.5)";

const bool registered_fill_lattice =
    io::Registry<FillType>::add({.name = "lattice",
                                 .schema = {.description = "Simple cubic lattice with rows along x.",
                                            .examples = {example},
                                            .rest = rest_of_filled_box},
                                 .read = read_filled_box,
                                 .centres = centres<false>,
                                 .estimated_count = estimated<false>}) &&
    io::Registry<FillType>::add({.name = "hcp",
                                 .schema = {.description = "Hexagonal close-packed arrangement.",
                                            .examples = {example},
                                            .rest = rest_of_filled_box},
                                 .read = read_filled_box,
                                 .centres = centres<true>,
                                 .estimated_count = estimated<true>});

}  // namespace

}  // namespace hilda::granular
