// SPDX-License-Identifier: GPL-3.0-or-later
/// Scene of free bodies with compliant contacts, stepped as in the experiments of the dissertation.
/// Source: Fang (2022), Sec. 4.4

#pragma once

#include "contact/detection/neighbor_list.hpp"

namespace hilda::contact {

/// Bodies without joints under gravity, with compliant contacts between them. One step of symplectic Euler:
///
///     a_n from the loads at t_n;   v_{n+1} = v_n + h a_n,   r_{n+1} = r_n + h v_{n+1}
///     J̄ (ω̄_{n+1} - ω̄_n)/h = τ̄_n,   A_{n+1} = A_n exp(h ω̄_{n+1})
///
/// This is rA-half-1 without constraints. Friction at t_n is computed from the displacement of the contact
/// points from t_{n-1} to t_n. For models with joints see ContactForce.
class Scene {
public:
    Vec3 gravity = Vec3(0, 0, -9.81);  ///< [m/s²]

    /// Adds a body and returns its index. A body without a finite mass keeps its velocity, one without a
    /// finite inertia keeps its ω̄. Throws lie::InvalidInput for a mass that is not positive.
    int add(const Inertia& inertia, const Motion& start);
    /// Adds a contact between bodies i and j and returns its index. The shapes are given in the body frames.
    /// Throws lie::InvalidInput for unknown or equal bodies.
    int add(const std::string& name, int i, const Shape& shape_i, int j, const Shape& shape_j,
            std::shared_ptr<const NormalLaw> law, std::shared_ptr<const FrictionModel> friction);

    /// Adds a body type and returns its index. Bodies of types are tested for contact with each other if a
    /// law is set for their two types.
    int add(const BodyType& type);
    /// Adds a body of a type and returns its index.
    int add_body(int type, const Motion& start);
    /// Sets the contact law between two types (which may be the same). A pair keeps its history while it is
    /// in the neighbour list.
    void set_contact_law(const std::string& name, int type_i, int type_j,
                         std::shared_ptr<const NormalLaw> law, std::shared_ptr<const FrictionModel> friction);

    /// Advances the scene by h [s]. Throws lie::NumericalFailure if a contact point is not found; poses and
    /// velocities are then unchanged, but the histories of some contacts may be advanced.
    void step(double h);

    /// Checks a start. Throws lie::InvalidInput if a contact cannot start in its pose or if h [s] exceeds the
    /// stability limit of a contact.
    void check(double h) const;

    /// A contact between two given bodies, with its state at the first node of the last step
    struct Pair {
        CompliantContact contact;
        int i, j;
        ContactHistory history = {};
        ContactState contact_state = {};
        Wrench wrench = {};
    };

    /// State of a pair of bodies in the neighbour list, at the first node of the last step
    struct PairState {
        ContactHistory history = {};
        ContactState contact_state = {};
        Wrench wrench = {};
    };

    double t = 0;  ///< [s]
    std::vector<Motion> body;
    std::vector<Pair> pair;
    /// Pairs of the bodies that were added by type; the force on body i is contact_state.N n + wrench.F
    NeighborList<CompliantContact, PairState> neighbors;
    double kinetic_energy() const;

private:
    template <class PairData>
    void add_contact_loads(const CompliantContact& contact, int i, int j, PairData& data, double h);

    struct Inverse {
        double m;
        Mat3 J_bar;
    };
    std::vector<Inertia> inertia;
    std::vector<Inverse> inverse;
    std::vector<Vec3> F, T;  ///< on each body, global, about its centre of mass
};

}  // namespace hilda::contact
