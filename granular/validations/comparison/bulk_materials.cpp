// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/validations/comparison/bulk_materials.hpp"

#include <cmath>

namespace hilda::granular {

namespace {

struct BulkPair {
    BulkMaterial i, j;
    double restitution, mu;
};

constexpr BulkPair pairs[] = {{M1, M1, 0.5, 0.3}, {M1, M2, 0.45, 0.2},   {M1, steel, 0.4, 0.2},
                              {M2, M2, 0.4, 0.4}, {M2, steel, 0.4, 0.2}, {steel, steel, 0.6, 0.5}};

}  // namespace

long BulkScale::number(long published) const
{
    return std::lround(static_cast<double>(published) / (size * size * size));
}

std::vector<Material> bulk_materials(const BulkScale& scale)
{
    const double s = scale.softness;
    return {{"M1", 2500, 1e9 / s, 0.2}, {"M2", 2000, 0.5e9 / s, 0.2}, {"steel", 7200, 210e9 / s, 0.2}};
}

void set_bulk_laws(World& world, const BulkScale& scale)
{
    const std::vector<Material> all = bulk_materials(scale);
    for (const BulkPair& p : pairs) {
        const Material &i = all[static_cast<std::size_t>(p.i)], &j = all[static_cast<std::size_t>(p.j)];
        const auto bound = static_cast<float>(p.mu);
        PairLaw law;
        law.normal = Hertz::of_materials(i, j, p.restitution);
        law.tangential =
            Mindlin{.spring = TangentialSpring::of_materials(i, j, p.restitution), .cap = {bound, bound}};
        world.set_law(p.i, p.j, law);
    }
}

double bulk_step(double radius, BulkMaterial material, const BulkScale& scale)
{
    return 0.16 * rayleigh_time(radius, bulk_materials(scale)[static_cast<std::size_t>(material)]);
}

std::vector<Particle> loose_layers(const Particle& grain, long count, double low, double half,
                                   const std::function<bool(const Vec3&)>& inside, Random& random)
{
    const double R = grain.radius, pitch = 2.12 * R, free = 0.05 * R;
    const auto in = [&](double most) { return random.number(-most, most); };
    const int n = static_cast<int>(half / pitch);
    std::vector<Particle> all;
    for (int layer = 0; static_cast<long>(all.size()) < count; ++layer)
        for (int a = -n; a <= n; ++a)
            for (int b = -n; b <= n && static_cast<long>(all.size()) < count; ++b) {
                Particle p = grain;
                p.r = {a * pitch + in(free), b * pitch + in(free), low + 1.06 * R + layer * pitch + in(free)};
                p.v = {in(0.1), in(0.1), in(0.1)};
                if (inside(p.r)) all.push_back(p);
            }
    return all;
}

}  // namespace hilda::granular
