// SPDX-License-Identifier: GPL-3.0-or-later
/// Scene of free rigid bodies with rigid unilateral contacts: a differential variational inequality (DVI),
/// stepped at velocity level. Theory: docs/theory/dvi.md

#pragma once

#include "contact/detection/neighbor_list.hpp"
#include "contact/scenes/dvi/cone_solver.hpp"

namespace hilda::contact {

/// Contact law of two rigid surfaces
struct RigidLaw {
    double mu = 0;           ///< Coulomb's friction coefficient
    double restitution = 0;  ///< Newton's coefficient of restitution e, in [0, 1]
};

/// Options of the time stepping of a DviScene
struct DviOptions {
    /// Gap stabilisation: u_n ≥ -gap/h, so that an overlap is corrected too. Without it u_n ≥ -max(gap, 0)/h:
    /// approach is stopped and an overlap remains.
    bool stabilised = true;
    /// The first step has half the impulse of the loads. Velocities then belong to the middle of the steps,
    /// and smooth motion is of second order. Without it v_0 is taken as v_{-1/2}, an error of O(h).
    bool half_kick = true;
    /// Treatment of sliding contacts, which the relaxation separates. The lagged correction has no cost and
    /// an error of O(h) for smooth slip. It is unstable if the slip feeds back on the normal force: in a
    /// chain of balls that roll and rub on each other its error is multiplied in each step by z, (1 - c) z² +
    /// 2 c z - c = 0, and |z| > 1 for c = μ R/ρ > 1/4.
    enum Sliding {
        convex,  ///< the relaxed problem: a sliding contact separates with μ |u_t| and has a gap of h μ |u_t|
        lagged,  ///< corrected by μ times the slip speed of the last step
        coulomb  ///< Coulomb's law by ConeSolver::solve_coulomb(), which may fail to converge, as in piles
    } sliding = coulomb;
    /// Contacts with a larger gap are ignored [m]. It must exceed the largest approach in one step.
    double margin = std::numeric_limits<double>::infinity();
};

/// Bodies without joints under gravity, with rigid contacts between them (Anitescu and Tasora 2010). One
/// step:
///
///     contact points, gaps and frames D at t_n
///     v* = v_{n-1/2} + h M⁻¹ F                          without contacts; rotation by node_momentum()
///     γ from the cone problem with  r = Dᵀ v* + b,      b_n = gap/h, or e v_n⁻ for a rebound
///     v_{n+1/2} = v* + M⁻¹ D γ
///     r_{n+1} = r_n + h v_{n+1/2},   A_{n+1} = A_n exp(h ω̄_{n+1/2})
///
/// For unequal steps the h of v* is the mean of the two steps; in the first step, with half_kick, it is h/2.
/// The initial guess of γ is the impulse of the last step. A step does not allocate, except for buffers that
/// grow.
class DviScene {
public:
    Vec3 gravity = Vec3(0, 0, -9.81);  ///< [m/s²]
    DviOptions options;
    ConeSolver solver;  ///< its tolerance and limits can be set

    /// Adds a body and returns its index. A body without a finite mass keeps its velocity, one without a
    /// finite inertia keeps its ω̄. Throws lie::InvalidInput for a mass that is not positive.
    int add(const Inertia& inertia, const Motion& start);
    /// Adds a contact between bodies i and j and returns its index. The shapes are given in the body frames.
    /// Throws lie::InvalidInput for unknown or equal bodies, for two fixed bodies and for a law out of range.
    int add(const std::string& name, int i, const Shape& shape_i, int j, const Shape& shape_j,
            const RigidLaw& law);

    /// Adds a body type and returns its index. Bodies of types are tested for contact with each other if a
    /// law is set for their two types.
    int add(const BodyType& type);
    /// Adds a body of a type and returns its index.
    int add_body(int type, const Motion& start);
    /// Sets the contact law between two types (which may be the same). Pairs are searched within
    /// neighbors.margin.
    void set_contact_law(const std::string& name, int type_i, int type_j, const RigidLaw& law);

    /// Advances the scene by h [s]. Throws lie::NumericalFailure if a contact point is not found and
    /// ConeNoConvergence if the impulses do not converge; the bodies are then as they were at t_n. Throws
    /// lie::InvalidInput for h ≤ 0.
    void step(double h);

    /// A pair of surfaces with their law and contact detector
    struct RigidContact {
        std::string name;
        RigidLaw law;
        std::unique_ptr<const Detector> detector;
    };
    /// State of a pair of bodies at the first node of the last step
    struct PairState {
        bool found = false;          ///< `points` is set
        PreviousPoints points = {};  ///< contact points in the body frames
        ContactPoint contact_point = {};
        bool active = false;    ///< the gap is within the margin
        Vec3 F = Vec3::Zero();  ///< mean contact force of the step on body i at C() [N]; -F acts on body j
        double N() const { return contact_point.n.dot(F); }
    };
    struct Pair {
        RigidContact contact;
        int i, j;
        PairState state = {};
    };

    double t = 0;  ///< [s]
    /// Poses at t. rdot and omega_bar belong to the middle of the last step; rddot is their change over a
    /// step divided by its length, so that v_n = v_{n+1/2} - h/2 r̈ at the first node of the last step.
    std::vector<Motion> body;
    std::vector<Pair> pair;
    NeighborList<RigidContact, PairState> neighbors;
    ConeSolver::Outcome outcome;  ///< solver statistics of the last step
    /// Number of active contacts in the last step
    int contacts() const { return static_cast<int>(problem.contact.size()); }
    double kinetic_energy() const;

private:
    RigidContact make_contact(const std::string& name, const Shape& i, const Inertia& of_i, const Shape& j,
                              const Inertia& of_j, const RigidLaw& law) const;
    void add_contact_rows(const RigidContact& of, int i, int j, PairState& state, double margin);
    void predict_free_velocities(double h_before, double h);
    void assemble_problem(double h, double kick);
    void apply_impulses(double h, double kick);

    struct Inverse {
        double m;
        Mat3 J_bar;
        bool spherical;  ///< J̄ is a multiple of I: no gyroscopic term
    };
    struct ActiveContact {
        PairState* state;
        double restitution;
    };
    std::vector<Inertia> inertia;
    std::vector<Inverse> inverse;
    double h_previous = 0;
    ConeProblem problem;
    std::vector<ActiveContact> active;
    std::vector<Vec3> momentum;  // angular momentum at t_n, body frame
    std::vector<ConeProblem::Velocity> start_velocity, free_velocity, velocity_change;
    std::vector<Vec3> u_start, u_free, gamma;
    std::vector<double> slip;
    std::vector<Vec3> omega_bar;
};

}  // namespace hilda::contact
