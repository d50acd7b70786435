// SPDX-License-Identifier: GPL-3.0-or-later
/// Distributions of the radii of particles.

#pragma once

#include "granular/backend/split_mix.hpp"
#include "granular/reading/object_reader.hpp"
#include "io/schema/type_schema.hpp"

#include <vector>

namespace hilda::granular {

/// What a share of a size distribution is a share of: the number or the mass of the particles
enum class Share { of_number, of_mass };

/// A distribution of radii on a finite interval: pieces of constant density by number or by mass.
///
/// With f_n and f_m the densities of the radius R by number and by mass,
///
///     f_m(R) = R³ f_n(R) / ∫ R³ f_n dR
///
/// since all particles of a distribution have the same density. Particles are drawn by number: a distribution
/// by mass is converted piece by piece, in closed form.
class Sizes {
public:
    /// `weight`: of the piece, over those of the others. A piece with low = high is a class of equal radii.
    struct Piece {
        double low, high, weight;  // [m, m, -]
    };

    /// One radius [m]
    explicit Sizes(double radius = 1) : Sizes({{radius, radius, 1}}, Share::of_number) {}
    /// Pieces in ascending order of the radii, at least one, with 0 < low ≤ high and a positive sum of the
    /// weights
    Sizes(const std::vector<Piece>& pieces, Share share);

    /// Radius below which the share u of the particles is, by number [m], for u in [0, 1)
    double quantile(double u) const;
    /// A random radius, from one random number [m]
    double draw(Random& random) const { return quantile(random.number()); }

    double least() const { return pieces.front().low; }      ///< [m]
    double largest() const { return pieces.back().high; }    ///< [m]
    double mean_cube() const;                                ///< mean of R³ by number [m³]
    bool is_single() const { return least() == largest(); }  ///< whether all radii are equal

private:
    std::vector<Piece> pieces;  ///< weights: shares of the number of particles
    std::vector<double> below;  ///< share of the particles in the pieces before each one; at the end 1
    Share constant;             ///< the density of this is constant within a piece
};

/// A type of size distribution. A file registers it by io::Registry<SizeType>::add.
struct SizeType {
    std::string name;  ///< value of the key "type"
    io::TypeSchema schema;
    /// Reads the keys besides type and by. Throws io::InvalidInput.
    std::vector<Sizes::Piece> (*read)(ObjectReader& o) = nullptr;
};

/// Reads a size distribution: the keys type, by and those of the type. Throws io::InvalidInput.
Sizes read_sizes(ObjectReader o);

/// Reads the sizes of a set of particles: sizes, or radius (with a default) and least_radius, between which
/// the radii are uniformly distributed. Throws io::InvalidInput.
Sizes read_radius(ObjectReader& o, const std::optional<double>& fallback = {});

/// What the schema says about keys of fills and insertions
inline constexpr io::About
    about_random_v = {"Magnitude of a velocity in a random direction that is added for each particle [m/s].",
                      "0.1"},
    about_seed = {"Seed of the random numbers.", "2"};

/// Reads the keys least_radius and largest_radius, between which a distribution is cut off, with defaults
/// [m]. The two texts are the sentences of their descriptions on the defaults. Throws io::InvalidInput.
std::pair<double, double> read_limits(ObjectReader& o, const std::optional<double>& least,
                                      const std::optional<double>& largest,
                                      const std::string& about_least = "",
                                      const std::string& about_largest = "");

}  // namespace hilda::granular
