// SPDX-License-Identifier: GPL-3.0-or-later
/// Insertion of particles during a run.

#pragma once

#include "granular/insertion/region.hpp"
#include "granular/insertion/sizes.hpp"
#include "granular/reading/clump_keys.hpp"
#include "granular/world/groups.hpp"
#include "granular/world/world.hpp"

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>

namespace hilda::granular {

/// No place was found for a particle. what() has the name of the insertion, its region and the number of
/// tries.
class InsertionBlocked : public io::NumericalFailure {
public:
    explicit InsertionBlocked(const std::string& what) : NumericalFailure("insertion_blocked", what) {}
};

/// Amounts and velocities of an insertion from a time on. A change of the run begins another flow.
struct InsertionFlow {
    double rate = 0, mass_rate = 0;                       ///< one of the two is positive, or none [1/s, kg/s]
    double to = std::numeric_limits<double>::infinity();  ///< [s]
    Vec3 v = {0, 0, 0};                                   ///< [m/s]
    double random_v = 0;  ///< magnitude of an added velocity of random direction [m/s]
    bool active = true;   ///< otherwise nothing is inserted

    double since = 0;             ///< begin of the flow [s]
    double number = 0, mass = 0;  ///< that are due from earlier flows, with fractions of a particle [, kg]

    /// Whether the flow has the same values in the case
    bool has_values_of(const InsertionFlow& o) const;
    void transfer(io::Archive& a);
};

/// An entry of `insert`
struct InsertionSpec {
    static constexpr std::int64_t no_limit = std::numeric_limits<std::int64_t>::max();

    std::string name;
    InsertionRegion region;
    Sizes sizes;
    InsertionFlow flow;                 ///< at the start of the run
    std::int64_t count = no_limit;      ///< largest number of particles; without a rate all are due at `from`
    double from = 0;                    ///< [s]
    long first_step = 0, interval = 1;  ///< of the insertions [steps]
    int material = 0;
    double density = 0;  ///< of a particle; of clumps their mass over the volume of the sphere [kg/m³]
    PlacedClumps clumps =
        {};  ///< in place of the particles, whose sizes are those of the spheres around them
    std::uint16_t replica = 0;
    bool postpones = true;     ///< a particle that finds no place waits for the next insertion
    long most_tries = 100000;  ///< positions in turn without place, after which the run ends
    std::uint64_t seed = 1;
    int group = Groups::none;

    static constexpr long tries_at_once = 200;  ///< positions that are tried for a particle in one insertion

    /// Number of particles that are due until t, with a fraction, or their mass [kg] with a mass_rate
    double due(const InsertionFlow& of, double t) const;
    double mean_mass() const;  ///< of a particle [kg]
    /// Largest number of particles until t; with a mass rate an estimate from above
    double largest_count(double t) const;
    /// A particle with a radius, without a place
    Particle particle(double radius) const;
    /// Particles that represent the distribution of the sizes; for clumps the spheres around them
    std::vector<Particle> samples() const;
    /// Announces this number of particles or clumps to a world. Throws io::InvalidInput.
    void announce(World& world, std::size_t number) const;
};

/// An insertion and its state.
///
/// Particles are inserted before the steps first_step, first_step + interval, ...: those that are due at this
/// time and were not inserted yet. The centres are random places in the region where the particle touches
/// nothing. A clump touches with its spheres. The random numbers depend on the seed and the earlier
/// insertions only.
class Insertion {
public:
    explicit Insertion(const InsertionSpec& spec);

    /// Inserts the particles that are due; called before each step. Returns the id of the first one, if there
    /// are any. Throws InsertionBlocked, and then the state and the world are as before.
    std::optional<std::uint32_t> before_step(World& world);

    const InsertionSpec& what() const { return spec; }
    std::int64_t count() const { return state.count; }  ///< of all inserted particles; a clump counts as one
    double mass() const { return state.mass; }          ///< of all inserted particles [kg]
    double due_mass(double t) const;                    ///< mass that should be inserted until t [kg]
    /// A warning if the inserted mass is less than the due one by more than a tenth and than ten particles;
    /// else empty. h: step size [s]
    std::string shortfall(double t, double h) const;
    void transfer(io::Archive& a);

    /// From the time t on the flow has the values of another one. What was due until then stays due: between
    /// a number and a mass it is converted by the mean mass of a particle. Without effect if the values are
    /// the same.
    void begin_flow(const InsertionFlow& of, double t);

private:
    /// Written to checkpoints as bytes, without padding
    struct State {
        std::uint64_t random = 0;  ///< state of the random numbers
        std::int64_t count = 0;    ///< of inserted particles
        double mass = 0;           ///< of inserted particles [kg]
        double radius = 0;         ///< of the next particle [m]; 0: not drawn yet
        std::int64_t tries = 0;    ///< positions without place since the last particle
        double blocked_since = 0;  ///< time of the first of them [s]
    };

    bool is_due(const State& now, double t) const;
    [[noreturn]] void throw_blocked(const State& now, double t) const;

    InsertionSpec spec;
    InsertionFlow flow;  ///< part of the state
    State state;
};

/// All insertions of a case
struct Insertions {
    std::vector<Insertion> all;
    std::shared_ptr<Groups> groups = {};  ///< that learn of the inserted particles; nullptr if there are none

    std::int64_t count() const;
    double mass() const;
    double due_mass(double t) const;  ///< [kg]
    /// Tells the world which particles will come until t, and inserts them before its steps. The list
    /// outlives the world.
    void start(World& world, double t);
    void transfer(io::Archive& a);
};

/// Reads an entry of `insert`, without material and replica, of a case with a step h and gravity [s, m/s²].
/// `world`: with the templates of clumps. Throws io::InvalidInput.
InsertionSpec read_insertion(ObjectReader& o, const std::string& name, double h, const Vec3& gravity,
                             const World& world);

}  // namespace hilda::granular
