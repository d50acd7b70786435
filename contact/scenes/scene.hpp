// SPDX-License-Identifier: GPL-3.0-or-later
/// Free bodies that touch each other, stepped as in the experiments of the dissertation.   Fang (2022), Sec. 4.4

#pragma once

#include "contact/detection/neighbor_list.hpp"

namespace hilda::contact {

/// Bodies without joints under gravity, and contacts between them. One step of symplectic Euler:
///
///     a_n from the loads at t_n;   v_{n+1} = v_n + h a_n,   r_{n+1} = r_n + h v_{n+1}
///     J̄ (ω̄_{n+1} - ω̄_n)/h = τ̄_n,   A_{n+1} = A_n exp(h ω̄_{n+1})
///
/// which is rA-half-1 without constraints. Friction at t_n comes from how the contact points moved from t_{n-1} to
/// t_n. For models with joints see ContactForce.
class Scene {
public:
    Vec3 gravity = Vec3(0, 0, -9.81);  ///< [m/s²]

    /// A body and its number. Without a finite mass it keeps its velocity, without finite inertia its ω̄.
    int add(const Inertia& inertia, const Motion& start);
    /// A contact between bodies i and j, and its number; both shapes in the frames of their bodies.
    int add(const std::string& name, int i, const Shape& shape_i, int j, const Shape& shape_j,
            std::shared_ptr<const NormalLaw> law, std::shared_ptr<const FrictionModel> friction);

    /// A kind of bodies, of which any two that come near each other are in contact, and its number
    int add(const BodyType& kind);
    /// A body of a kind
    int enter(int kind, const Motion& start);
    /// The contact that two bodies of these kinds have, or two of one. Its memory lasts while they are near.
    void between(const std::string& name, int kind_i, int kind_j, std::shared_ptr<const NormalLaw> law,
                 std::shared_ptr<const FrictionModel> friction);

    /// lie::NumericalFailure where a contact finds no touch; the scene then stands between two steps.
    void step(double h);

    /// InvalidInput where a contact objects to the start, or h [s] is above the bound of a contact.
    void check(double h) const;

    /// A contact as it was when the last step left its node
    struct Pair {
        CompliantContact contact;
        int i, j;
        ContactHistory history = {};
        ContactState contact_state = {};
        Wrench wrench = {};
    };

    /// What two bodies of a crowd keep while they are near
    struct Encounter {
        ContactHistory history = {};
        ContactState contact_state = {};
        Wrench wrench = {};
    };

    double t = 0;  ///< [s]
    std::vector<Motion> body;
    std::vector<Pair> pair;
    NeighborList<CompliantContact, Encounter>
        neighbors;  ///< what add(Kind) made; the force on body i is meeting.N n + wrench.F
    double kinetic_energy() const;

private:
    template <class Kept>
    void contact_point(const CompliantContact& contact, int i, int j, Kept& kept, double h);

    struct Inverse {
        double m;
        Mat3 J_bar;
    };
    std::vector<Inertia> inertia;
    std::vector<Inverse> inverse;
    std::vector<Vec3> F, T;  ///< on each body, global, about its centre of mass
};

}  // namespace hilda::contact
