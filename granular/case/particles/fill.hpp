// SPDX-License-Identifier: GPL-3.0-or-later
/// Initial particles: on a lattice, close-packed, at random without contact, or from a table.

#pragma once

#include "granular/backend/split_mix.hpp"
#include "granular/insertion/sizes.hpp"
#include "granular/reading/clump_keys.hpp"
#include "granular/reading/object_reader.hpp"
#include "io/schema/type_schema.hpp"

#include <functional>

namespace hilda::granular {

struct FillType;

/// An entry of `fill`
struct FillSpec {
    const FillType* type = nullptr;
    Vec3 low = {0, 0, 0}, high = {0, 0, 0};  ///< corners of the box that contains the spheres [m]
    double radius = 0;                       ///< the largest one [m]
    Sizes sizes = Sizes();                   ///< of the particles that are not from a table
    double spacing = 0;                      ///< distance of neighbouring centres [m]
    double jitter = 0;          ///< random displacement over the largest one without contact, in [0, 1]
    std::size_t max_count = 0;  ///< largest number of particles; 0: no limit
    std::uint64_t seed = 1;
    int material = 0;  ///< index; -1 with particles of a table: as in the table
    std::uint16_t replica = 0;
    int attached_to = -1;                   ///< number of a boundary; -1: none
    Vec3 v = {0, 0, 0};                     ///< [m/s]
    double random_v = 0;                    ///< magnitude of an added velocity of random direction [m/s]
    std::vector<Particle> particles = {};   ///< of the table; empty for the other types
    std::uint64_t checksum = 0;             ///< of the table file
    std::string file = {};                  ///< name of the table file
    std::vector<std::string> unknown = {};  ///< messages about columns of the table without effect
    PlacedClumps clumps = {};               ///< in place of the particles
};

/// A type of fill. A file registers it by io::Registry<FillType>::add.
struct FillType {
    std::string name;  ///< value of the key "type"
    io::TypeSchema schema;
    /// Reads the keys besides type, material and replica. `radius`: default of the radius [m]. Throws
    /// io::InvalidInput.
    FillSpec (*read)(ObjectReader& o, const std::optional<double>& radius);
    /// Centres between low and high [m], at most max_count if the order is that of the particles
    std::vector<Vec3> (*centres)(const FillSpec& f, const Vec3& low, const Vec3& high,
                                 Random& random) = nullptr;
    /// Estimated number of centres in a box of this size [m]
    double (*estimated_count)(const FillSpec& f, const Vec3& size) = nullptr;
};

/// Reads the keys of a box that is filled with spheres, see FillSpec. `radius`: default of the radius [m].
/// Throws io::InvalidInput.
FillSpec read_filled_box(ObjectReader& o, const std::optional<double>& radius);

/// The conditions of the schema on several keys of such a box
inline const std::string rest_of_filled_box =
    R"("if": {"required": ["clump"]}, "then": {"not": {"anyOf": [{"required": ["material"]}, )"
    R"({"required": ["attached_to"]}]}}, "else": {"anyOf": [{"required": ["radius"]}, )"
    R"({"required": ["sizes"]}], "not": {"required": ["orientation"]}})";

/// Reads an entry of `fill`, without material and replica. Throws io::InvalidInput.
FillSpec read_fill(ObjectReader& o, const std::optional<double>& radius = {});

/// Reads particles from a table (CSV) such as the particles.csv of a run: a line of column names and one line
/// per particle. Required columns: x, y, z, radius. Optional columns: material (index), vx, vy, vz, omega_x,
/// omega_y, omega_z, e0 to e3. Other columns have no effect, except that `unknown` gets a message for each
/// of them but id. SI units, global frame. Throws io::InvalidInput with file and line.
std::vector<Particle> particles_of_csv(const std::string& text, const std::string& file,
                                       std::vector<std::string>* unknown = nullptr);

/// "FILE:LINE" of the particle with this number, counted from 0, in a table file; "FILE" if it cannot be read
std::string place_in_table(const std::string& file, std::size_t particle);

/// Estimated number of particles
double estimated_count(const FillSpec& filling);

/// Generates the particles and passes each to `use`. The result is the same on all platforms (see SplitMix).
/// Throws io::InvalidInput.
void fill(const FillSpec& filling, const std::function<void(const Particle&)>& use);
std::vector<Particle> fill(const FillSpec& filling);

}  // namespace hilda::granular
