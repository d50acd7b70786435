// SPDX-License-Identifier: GPL-3.0-or-later
/// Continuum fields of particles and contacts on a regular grid.
///                                         Goldhirsch (2010), Granular Matter 12, 239; Weinhart et al. (2012),
///                                         Granular Matter 14, 289 for boundaries

#pragma once

#include "granular/fields/cell_weights.hpp"

#include <array>
#include <vector>

namespace hilda::granular {

/// A particle that moves freely
struct FieldParticle {
    Vec3 r, v;            ///< centre and its velocity [m, m/s]
    double mass, volume;  ///< [kg, m³]
};

/// A contact of a particle that moves freely
struct FieldContact {
    Vec3 r;  ///< centre of the particle [m]
    Vec3 l;  ///< from the centre of the other particle, or from the contact point on a boundary, to r [m]
    Vec3 F;  ///< force on the particle [N]
    bool boundary;
};

struct FieldInput {
    std::vector<FieldParticle> particles;
    std::vector<FieldContact> contacts;
};

/// Fields of one cell. With i the particles, c the contacts and b those with boundaries:
///
///     density               ρ = Σ_i m_i φ(x - r_i)
///     volume_fraction           Σ_i V_i φ(x - r_i)
///     momentum            ρ v = Σ_i m_i v_i φ(x - r_i)
///     kinetic_stress            Σ_i m_i v'_i ⊗ v'_i φ(x - r_i),     v'_i = v_i - v(x)
///     contact_stress            Σ_c l_c ⊗ F_c ∫_0^1 φ(x - r_c + s l_c) ds
///     boundary_force            Σ_b F_b φ(x - r_b + l_b)
///
/// They satisfy the balance of momentum, with the sum σ of both stresses, positive in compression, and the
/// divergence in its first index:
///
///     ∂(ρ v)/∂t + div(ρ v ⊗ v + σ) = ρ g + boundary_force
///
/// Stresses are 3 × 3 by rows.
struct FieldValues {
    double density = 0, volume_fraction = 0;  ///< [kg/m³, -]
    Vec3 momentum = {0, 0, 0};                ///< density of momentum [kg/(m² s)]
    Vec3 velocity = {0, 0, 0};                ///< momentum over density; 0 without particles [m/s]
    std::array<double, 9> kinetic_stress = {}, contact_stress = {};  ///< [Pa]
    Vec3 boundary_force = {0, 0, 0};  ///< density of the forces of boundaries on particles [N/m³]
};

/// Sums over the particles and contacts of one or more instants, from which the fields follow. The mean over
/// the instants is that of density, momentum, momentum flux and forces, so that the mean fields satisfy the
/// balance of momentum as well. The velocity is the quotient of the means, and the kinetic stress has the
/// fluctuations about it.
///
/// The results do not depend on the number of threads: a cell adds its parts in the order of the input.
class FieldSums {
public:
    FieldSums(const FieldGrid& grid, const Kernel& kernel)
        : grid(grid), kernel(kernel), weights(grid, kernel), cells(grid.count())
    {}

    void add(const FieldInput& instant);
    /// Number of instants added since the last reset()
    long instants() const { return count; }
    void reset();
    /// Memory of the sums of a cell [bytes]
    static constexpr std::size_t bytes_of_cell() { return sums * sizeof(double); }
    /// Means over the instants of the cell with number k
    FieldValues values(std::size_t k) const;

    /// Writes or reads the sums. Archive: io::Archive
    template <class Archive>
    void transfer(Archive& a)
    {
        a.value(count);
        const std::size_t n = cells.size();
        a.list(cells);
        a.check(cells.size() == n && is_finite() && count >= 0, "the sums of a field are wrong");
    }

private:
    enum Sum { mass, volume, momentum, flux = 5, stress = 11, force = 20, sums = 23 };
    /// Addends of `count` sums from number `first` on, which are multiplied by the weights of the cells
    struct Part {
        std::vector<Footprint> footprints;
        int first, count;
        std::array<double, 11> addend;
    };

    bool is_finite() const;
    std::vector<Part> parts(const FieldParticle& p) const;
    std::vector<Part> parts(const FieldContact& c) const;
    template <class Item>
    void add_each(const std::vector<Item>& items);
    void add_layer(int layer, std::size_t axis, const std::vector<Part>& all);

    FieldGrid grid;
    Kernel kernel;
    CellWeights weights;
    std::vector<std::array<double, sums>> cells;
    long count = 0;
};

}  // namespace hilda::granular
