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
    const auto& type =
        io::read_type<SizeType>(o, {"Size distribution", "type", "Type of the distribution."}, "sizes_");
    const std::string by =
        o.one_of("by", {"number", "mass"},
                 {"Whether the shares of the distribution are of the number or of the mass of the particles.",
                  R"("mass")"},
                 "number");
    const std::vector<Sizes::Piece> pieces = type.read(o);
    o.finish();
    return {pieces, by == "mass" ? Share::of_mass : Share::of_number};
}

Sizes read_radius(ObjectReader& o, const std::optional<double>& fallback)
{
    o.note("radius", "positive",
           {"Radius of the particles, or the largest radius [m]. Either radius or sizes is required, unless "
            "there is clump.",
            "0.001"});
    o.note("least_radius", "positive",
           {"Smallest radius [m]. Radii are uniformly distributed between least_radius and radius. It must "
            "not exceed radius. By default equal to radius.",
            "0.0008"});
    o.note("sizes", R"("$ref": "#/$defs/sizes")",
           {"Distribution of the radii, in place of radius and least_radius.",
            R"({"type": "lognormal", "median": 0.001, "deviation": 0.2})"});
    for (const std::string key : {"radius", "least_radius"}) {
        o.note_exclusive(std::array<std::string, 2>{key, "sizes"});
        if (o.has(key) && o.has("sizes")) o.fail(key, key + " must not be given together with sizes");
    }
    if (o.has("sizes")) return read_sizes(o.object("sizes", {}, "sizes"));
    const double radius = o.positive("radius", {}, fallback), least = o.number("least_radius", {}, radius);
    if (least > 0 && least <= radius)
        o.positive("least_radius", {}, radius);  // in single precision
    else
        o.fail("least_radius",
               "least_radius must be positive and not greater than radius, got " + io::shortest(least));
    return Sizes({{least, radius, 1}}, Share::of_number);
}

std::pair<double, double> read_limits(ObjectReader& o, const std::optional<double>& least,
                                      const std::optional<double>& largest, const std::string& about_least,
                                      const std::string& about_largest)
{
    const std::string first = "Smallest radius [m]." + about_least,
                      second = "Largest radius [m]." + about_largest;
    const double low =
                     o.positive("least_radius", {.text = first, .example = "8e-4", .computed = true}, least),
                 high = o.positive("largest_radius", {.text = second, .example = "1.2e-3", .computed = true},
                                   largest);
    if (!(low <= high))
        o.fail(o.has("least_radius") ? "least_radius" : "largest_radius",
               "least_radius must not be above largest_radius, " + io::shortest(high) + ", got " +
                   io::shortest(low));
    return {low, high};
}

}  // namespace hilda::granular
