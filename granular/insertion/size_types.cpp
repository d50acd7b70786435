// SPDX-License-Identifier: GPL-3.0-or-later
/// Size distributions uniform, normal, lognormal and table.
#include "granular/insertion/sizes.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace hilda::granular {

namespace {

constexpr int pieces_of_curve = 1024;  ///< of a density that is not constant

/// Share of the standard normal distribution between a and b; in a tail without cancellation
double normal_share(double a, double b)
{
    const auto above = [](double z) { return std::erfc(z / std::numbers::sqrt2) / 2; };
    return a > 0 ? above(a) - above(b) : above(-b) - above(-a);
}

/// Radii between two limits with a normally distributed z(R)
template <class Z, class Radius>
std::vector<Sizes::Piece> normal_pieces(ObjectReader& o, std::pair<double, double> limits, const Z& z,
                                        const Radius& radius)
{
    const auto [low, high] = limits;
    std::vector<Sizes::Piece> all;
    double before = low;
    for (int k = 1; k <= pieces_of_curve; ++k) {
        const double share = static_cast<double>(k) / pieces_of_curve,
                     after = k == pieces_of_curve ? high : radius(z(low) + share * (z(high) - z(low)));
        if (after > before) all.push_back({before, after, normal_share(z(before), z(after))});
        before = std::max(before, after);
    }
    double sum = 0;
    for (const Sizes::Piece& p : all) sum += p.weight;
    if (all.empty() || !(sum > 1e-3))
        o.fail("deviation", "the limits must contain at least 1e-3 of the distribution, " +
                                io::shortest(low) + " to " + io::shortest(high) + ", got " +
                                io::shortest(sum));
    return all;
}

std::vector<Sizes::Piece> read_uniform(ObjectReader& o)
{
    const auto [low, high] = read_limits(o, {}, {});
    return {{low, high, 1}};
}

std::vector<Sizes::Piece> read_normal(ObjectReader& o)
{
    const double mean = o.positive("mean", {"Mean radius of the distribution without limits [m].", "1e-3"});
    const double s =
        o.positive("deviation", {"Standard deviation of the radius without limits [m].", "1e-4"});
    return normal_pieces(
        o,
        read_limits(o, std::max(mean - 3 * s, mean / 10), mean + 3 * s,
                    " By default three deviations below the mean, but at least a tenth of it.",
                    " By default three deviations above the mean."),
        [&](double R) { return (R - mean) / s; }, [&](double z) { return mean + s * z; });
}

std::vector<Sizes::Piece> read_lognormal(ObjectReader& o)
{
    const double median =
        o.positive("median", {"Median radius of the distribution without limits [m].", "1e-3"});
    const double s = o.positive(
        "deviation", {"Standard deviation of the natural logarithm of the radius without limits [-].", "0.2",
                      R"("maximum": 3)"});
    constexpr double most = 3;  // radii over 9 decades within three deviations
    if (s > most) o.fail("deviation", "deviation must be at most 3, got " + io::shortest(s));
    return normal_pieces(
        o,
        read_limits(o, median * std::exp(-3 * s), median * std::exp(3 * s),
                    " By default median exp(-3 deviation).", " By default median exp(3 deviation)."),
        [&](double R) { return std::log(R / median) / s; },
        [&](double z) { return median * std::exp(s * z); });
}

/// The numbers of a list with at least one element
std::vector<double> read_list(ObjectReader& o, const char* key, std::size_t count)
{
    const io::Json::List& all = o.list(key, true);
    if (all.empty() || (count > 0 && all.size() != count))
        o.fail(key, std::string(key) +
                        (count > 0 ? " must have as many numbers as radii, " + std::to_string(count)
                                   : " must have a number at least") +
                        ", got " + std::to_string(all.size()));
    return o.numbers(key, all.size());
}

std::vector<Sizes::Piece> read_table(ObjectReader& o)
{
    o.note("radii", R"("type": "array", "items": {"type": "number", "exclusiveMinimum": 0}, "minItems": 1)",
           {"Radii in ascending order [m].", "[5e-4, 1e-3]"});
    constexpr const char* shares =
        R"("type": "array", "items": {"type": "number", "minimum": 0}, "minItems": 1)";
    o.note("fractions", shares,
           {"Fraction of the particles of each radius, over the sum of all [-].", "[0.3, 0.7]"});
    o.note("passing", shares,
           {"Fraction of the particles below each radius, linear between the radii [-]. It begins with 0 and "
            "ends with 1.",
            "[0, 1]"});
    const std::vector<double> radii = read_list(o, "radii", 0);
    for (std::size_t k = 0; k < radii.size(); ++k)
        if (!(radii[k] >= std::numeric_limits<float>::min()) || (k > 0 && !(radii[k] > radii[k - 1])))
            o.fail("radii", k, "radii must be positive and ascending, got " + io::shortest(radii[k]));
    if (o.has("fractions") == o.has("passing"))
        o.fail(o.has("passing") ? "passing" : "radii",
               std::string("a table must have either fractions or passing, got ") +
                   (o.has("passing") ? "both" : "none"));
    std::vector<Sizes::Piece> all;
    if (o.has("fractions")) {
        const std::vector<double> fractions = read_list(o, "fractions", radii.size());
        double sum = 0;
        for (std::size_t k = 0; k < radii.size(); ++k) {
            if (!(fractions[k] >= 0))
                o.fail("fractions", k, "fractions must not be negative, got " + io::shortest(fractions[k]));
            sum += fractions[k];
            all.push_back({radii[k], radii[k], fractions[k]});
        }
        if (!(sum > 0)) o.fail("fractions", "fractions must have a positive sum, got " + io::shortest(sum));
        return all;
    }
    const std::vector<double> passing = read_list(o, "passing", radii.size());
    if (radii.size() < 2) o.fail("radii", "radii must have two numbers at least with passing, got 1");
    for (std::size_t k = 0; k < radii.size(); ++k) {
        if (k > 0 && !(passing[k] >= passing[k - 1]))
            o.fail("passing", k, "passing must not decrease, got " + io::shortest(passing[k]));
        if (k > 0) all.push_back({radii[k - 1], radii[k], passing[k] - passing[k - 1]});
    }
    for (const auto& [k, value] : {std::pair<std::size_t, double>{0, 0}, {passing.size() - 1, 1}})
        if (passing[k] != value)
            o.fail("passing", k,
                   std::string("passing must be ") + (k == 0 ? "0 at the smallest" : "1 at the largest") +
                       " radius, got " + io::shortest(passing[k]));
    return all;
}

const bool registered_size_types =
    io::Registry<SizeType>::add(
        {.name = "uniform",
         .schema = {.description = "Radii with a constant density between two limits.",
                    .examples = {R"("least_radius": 8e-4, "largest_radius": 1.2e-3)"}},
         .read = read_uniform}) &&
    io::Registry<SizeType>::add(
        {.name = "normal",
         .schema = {.description = "Normally distributed radii, without those beyond the two limits.",
                    .examples = {R"("mean": 1e-3, "deviation": 1e-4)"}},
         .read = read_normal}) &&
    io::Registry<SizeType>::add(
        {.name = "lognormal",
         .schema = {.description =
                        "Radii with a normally distributed logarithm, without those beyond the two limits.",
                    .examples = {R"("median": 1e-3, "deviation": 0.2, "by": "mass")"}},
         .read = read_lognormal}) &&
    io::Registry<SizeType>::add(
        {.name = "table",
         .schema = {.description = "Classes of equal radii with fractions, or a sieve curve with the passing "
                                   "fractions. One of the keys fractions and passing is required.",
                    .examples = {R"("radii": [5e-4, 8e-4, 1e-3], "passing": [0, 0.3, 1], "by": "mass")"},
                    .rest = R"("oneOf": [{"required": ["fractions"]}, {"required": ["passing"]}])"},
         .read = read_table});

}  // namespace

}  // namespace hilda::granular
