// SPDX-License-Identifier: GPL-3.0-or-later
/// Free rigid bodies with unilateral contacts: a differential variational inequality, stepped at velocity level.

#pragma once

#include "contact/detection/neighbor_list.hpp"
#include "contact/scenes/dvi/cone_solver.hpp"

namespace hilda::contact {

/// What holds between two rigid surfaces
struct RigidLaw {
    double mu = 0;           ///< Coulomb's coefficient
    double restitution = 0;  ///< Newton's, in [0, 1]
};

/// How a DviScene steps
struct DviOptions {
    /// Whether γ may push the surfaces apart: u_n ≥ -gap/h wherever they are, and so in an overlap. Without, only
    /// approach is stopped, u_n ≥ -max(gap, 0)/h, and overlap stays.
    bool stabilised = true;
    /// The first step has half the impulse of the forces, so that velocities are those in the middle of the steps, which
    /// gives second order to what is smooth. Without, v_0 counts as v_{-1/2}, an error of O(h) that hides the method.
    bool half_kick = true;
    /// What is done about the lift of the relaxation. The lagged correction costs nothing and leaves O(h) of a smooth
    /// slip, but is unstable where slip feeds back on the normal force: in a chain of balls that roll and rub on each other
    /// its error is multiplied each step by z, (1 - c) z² + 2 c z - c = 0, which is beyond -1 for c = μ R/ρ > 1/4.
    enum Sliding {
        convex,  ///< the cone problem as it is: what slides is lifted off at μ |u_t|, to a gap of h μ |u_t|
        lagged,  ///< corrected by the slip speed of the step before
        coulomb  ///< the law itself, by ConeSolver::solve_coulomb(), which may find no solution
    } sliding = convex;
    /// Contacts with a wider gap than this take no part [m]. What can be closed within a step must be within it.
    double margin = std::numeric_limits<double>::infinity();
};

/// Bodies without joints under gravity, and rigid contacts between them (Anitescu and Tasora 2010). One step:
///
///     touches, gaps and frames D at t_n
///     v* = v_{n-1/2} + h M⁻¹ F                          without contacts; turning by node_momentum()
///     γ from the cone problem with  r = Dᵀ v* + b,      b_n = gap/h, or -e v_n⁻ where a contact rebounds
///     v_{n+1/2} = v* + M⁻¹ D γ
///     r_{n+1} = r_n + h v_{n+1/2},   A_{n+1} = A_n exp(h ω̄_{n+1/2})
///
/// Between nodes of unequal steps h is the mean of the two, and in the first step, with half_kick, half of it. The cone
/// problem begins with the impulses of the step before. A step takes nothing from the heap but for buffers that grow.
class DviScene {
public:
    Vec3 gravity = Vec3(0, 0, -9.81);  ///< [m/s²]
    DviOptions options;
    ConeSolver solver;  ///< with its tolerance

    /// A body and its number. Without a finite mass it keeps its velocity, without finite inertia its ω̄.
    int add(const Inertia& inertia, const Motion& start);
    /// A contact between bodies i and j, and its number; both shapes in the frames of their bodies.
    int add(const std::string& name, int i, const Shape& shape_i, int j, const Shape& shape_j,
            const RigidLaw& law);

    /// A kind of bodies, of which any two that come near each other are in contact, and its number
    int add(const BodyType& kind);
    /// A body of a kind
    int enter(int kind, const Motion& start);
    /// The contact that two bodies of these kinds have, or two of one. They are looked for within crowd.margin.
    void between(const std::string& name, int kind_i, int kind_j, const RigidLaw& law);

    /// lie::NumericalFailure where a contact finds no touch, ConeNoConvergence; the bodies are then as they were at t_n.
    void step(double h);

    /// A pair of surfaces
    struct Surfaces {
        std::string name;
        RigidLaw law;
        std::unique_ptr<const Detector> detector;
    };
    /// Two bodies as they were when the last step left its node
    struct Encounter {
        bool found = false;
        Points points = {};  ///< of the touch, in the bodies
        ContactPoint contact_point = {};
        bool active = false;    ///< within the margin
        Vec3 F = Vec3::Zero();  ///< on body i at touch.C() [N], -F on j
        double N() const { return contact_point.n.dot(F); }
    };
    struct Pair {
        Surfaces surfaces;
        int i, j;
        Encounter state = {};
    };

    double t = 0;  ///< [s]
    /// At t, but for rdot and omega_bar, which are those in the middle of the last step; rddot is their change over a step,
    /// so that v_n = v_{n+1/2} - h/2 v̈ of what was left.
    std::vector<Motion> body;
    std::vector<Pair> pair;
    NeighborList<Surfaces, Encounter> neighbors;
    ConeSolver::Outcome solved;                                                ///< of the last step
    int contacts() const { return static_cast<int>(problem.contact.size()); }  ///< active in the last step
    double kinetic_energy() const;

private:
    Surfaces surfaces(const std::string& name, const Shape& i, const Inertia& of_i, const Shape& j,
                      const Inertia& of_j, const RigidLaw& law) const;
    void detect_contact(const Surfaces& of, int i, int j, Encounter& state, double within);
    void release(double before, double h);
    void pose(double h, double kick);
    void advance(double h, double kick);

    struct Inverse {
        double m;
        Mat3 J_bar;
        bool round;  ///< J̄ is a multiple of I
    };
    struct Active {
        Encounter* state;
        double restitution;
    };
    std::vector<Inertia> inertia;
    std::vector<Inverse> inverse;
    double h_before = 0;
    ConeProblem problem;
    std::vector<Active> active;
    std::vector<Vec3> momentum;  // at t_n, body frame
    std::vector<ConeProblem::Velocity> start, freely, change;
    std::vector<Vec3> u_start, u_free, gamma;
    std::vector<double> slip;
    std::vector<Vec3> omega_bar;
};

}  // namespace hilda::contact
