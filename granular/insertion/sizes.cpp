// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/insertion/sizes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hilda::granular {

namespace {

/// Number of particles per mass of a piece with a constant density by mass, up to a constant factor: the mean
/// of R⁻³ over the piece
double number_per_mass(const Sizes::Piece& p)
{
    return (p.low + p.high) / (2 * p.low * p.low * p.high * p.high);
}

}  // namespace

Sizes::Sizes(const std::vector<Piece>& all, Share share) : pieces(all), constant(share)
{
    // relative to the largest radius, so that no power leaves the range of the numbers
    const double scale = pieces.back().high;
    if (share == Share::of_mass)
        for (Piece& p : pieces) p.weight *= number_per_mass({p.low / scale, p.high / scale, 1});
    std::erase_if(pieces, [](const Piece& p) { return p.weight == 0; });
    double sum = 0;
    for (const Piece& p : pieces) sum += p.weight;
    double before = 0;
    for (Piece& p : pieces) {
        below.push_back(before / sum);
        before += p.weight;
        p.weight /= sum;
    }
    below.push_back(1);
}

double Sizes::quantile(double u) const
{
    const auto next = std::upper_bound(below.begin(), below.end() - 1, u);
    const auto k = static_cast<std::size_t>(next - below.begin()) - 1;
    const Piece& p = pieces[k];
    if (p.low == p.high) return p.low;
    const double share = (u - below[k]) / (below[k + 1] - below[k]);
    if (constant == Share::of_number) return p.low + (p.high - p.low) * share;
    // the number below R is proportional to 1/low² - 1/R²
    const double ratio = p.low / p.high;
    return std::min(p.low / std::sqrt(1 - share * (1 - ratio * ratio)), p.high);
}

double Sizes::mean_cube() const
{
    double mean = 0;
    for (const Piece& p : pieces)
        mean += p.weight * (constant == Share::of_mass
                                ? 1 / number_per_mass(p)
                                : (p.low + p.high) * (p.low * p.low + p.high * p.high) / 4);
    return mean;
}

Sizes read_sizes(ObjectReader o)
{
    const SizeType& type = *io::Registry<SizeType>::find(o.one_of("type", io::Registry<SizeType>::names()));
    const bool by_mass = o.one_of("by", {"number", "mass"}, {}, "number") == "mass";
    const std::vector<Sizes::Piece> pieces = type.read(o);
    o.finish();
    return {pieces, by_mass ? Share::of_mass : Share::of_number};
}

Sizes read_radius(ObjectReader& o, const std::optional<double>& fallback)
{
    if (o.has("sizes")) {
        for (const char* key : {"radius", "least_radius"})
            if (o.has(key)) o.fail(key, std::string(key) + " must not be given together with sizes");
        return read_sizes(o.object("sizes"));
    }
    const double radius = o.positive("radius", {}, fallback), least = o.number("least_radius", {}, radius);
    if (least > 0 && least <= radius)
        o.positive("least_radius", {}, radius);  // in single precision
    else
        o.fail("least_radius",
               "least_radius must be positive and not greater than radius, got " + io::shortest(least));
    return Sizes({{least, radius, 1}}, Share::of_number);
}

std::pair<double, double> read_limits(ObjectReader& o, const std::optional<double>& least,
                                      const std::optional<double>& largest)
{
    const double low = o.positive("least_radius", {}, least),
                 high = o.positive("largest_radius", {}, largest);
    if (!(low <= high))
        o.fail(o.has("least_radius") ? "least_radius" : "largest_radius",
               "least_radius must not be above largest_radius, " + io::shortest(high) + ", got " +
                   io::shortest(low));
    return {low, high};
}

}  // namespace hilda::granular
