// SPDX-License-Identifier: GPL-3.0-or-later
/// Compliant contact of bodies with edges, which touch at several points.

#pragma once

#include "contact/compliant/compliant_force.hpp"
#include "contact/compliant/contact.hpp"
#include "contact/friction/tracked_force.hpp"
#include "contact/loaded_point.hpp"

#include <array>
#include <memory>
#include <vector>

namespace hilda::contact {

/// A compliant contact with the points of Detector::detect_all(). A point k with the share s_k and the
/// overlap δ_k has the loads of a contact with one point, times s_k:
///
///     N_k = s_k N(δ_k, δ̇_k),   friction s_k F(S_k, ...) with |F| ≤ μ N(δ_k, δ̇_k).
///
/// Two faces that lie on each other therefore have the stiffness of the normal law, at the centroid of their
/// common area, with any number of corners. A corner alone has its share of it.
///
/// Each point has its own friction history. A point continues the history of the point of the last node with
/// the same feature, and else of the nearest one within 5 % of the size whose feature has no point any more,
/// such as a corner that leaves the face below it.
class ManifoldForce final : public dae::Force, public CompliantForce {
public:
    /// A contact between two bodies of the model, of which one may be dae::ground. InvalidInput for surfaces
    /// without a detector, and for a law that needs curvatures unless one surface is smooth.
    ManifoldForce(const std::string& name, const dae::Model& model, int i, const Shape& shape_i, int j,
                  const Shape& shape_j, std::shared_ptr<const NormalLaw> law,
                  std::shared_ptr<const FrictionModel> friction);
    ~ManifoldForce() override;

    /// Whether the surfaces have several contact points: one of them is a Polytope
    static bool has_several_points(const Shape& i, const Shape& j);

    void add(const lie::State& x, lie::Loads& out) const override;
    double potential_energy(const lie::State& x) const override;
    double internal_energy(const lie::State& x) const override;
    bool is_passive() const override { return true; }
    std::string start_error(const lie::State& x) const override;

    /// A number made of the regimes of the points, which are internal states. Others may have the same.
    int discrete_states() const override { return 1; }
    int internal_states() const override;
    void update_internal_state(lie::State& x) const override;
    /// Throws NumericalFailure "contact_missed" if the bodies pass through each other within the step.
    void check_step(const lie::State& before, const lie::State& after) const override;

    double stable_step(const lie::State& x,
                       lie::LoadEvaluation evaluation = lie::LoadEvaluation::at_step) const override;
    double stable_step_with(const lie::State& x, lie::LoadEvaluation evaluation,
                            std::span<const int> near) const override;
    bool is_stable(const lie::State& x, double h, lie::LoadEvaluation evaluation,
                   std::span<const int> touching) const override;
    bool is_counted(const lie::State& x, Counted which) const override;

    int max_static_springs() const override { return springs_of_point * Manifold::most; }
    int static_springs(const lie::State& x, StaticSpring* out) const override;
    void set_static_forces(lie::State& x, const StaticForce* forces) const override;
    void check_derivatives(const lie::State& x, dae::DerivativeFindings& out) const override;

    std::array<int, 2> bodies() const override { return {i, j}; }
    int last_body() const override { return std::max(i, j); }
    std::string label() const override { return "contact '" + name + "'"; }

    double overlap(const lie::State& x) const override;
    double relative_overlap(const lie::State& x) const override;

    /// The contact points that have a force in the state x, ascending by features
    void points(const lie::State& x, std::vector<LoadedPoint>& out) const;
    /// The closest points of the surfaces, see Detector::detect()
    ContactPoint nearest(const lie::State& x) const;

    const int i, j;
    const CompliantContact contact;

private:
    static constexpr int springs_of_point = 3;
    class Point;
    struct TouchingPoint {
        const Point* point;  ///< the place of the history
        std::uint32_t feature;
        ContactHistory history;  ///< of the last node; empty for a new point
        ContactState now;

        TrackedForce::Instant at(const lie::State& x) const;
    };
    /// The points in contact in a state
    struct Touching {
        std::array<TouchingPoint, Manifold::most> all;
        int count = 0;

        const TouchingPoint* begin() const { return all.data(); }
        const TouchingPoint* end() const { return all.data() + count; }
    };
    void evaluate(const lie::State& x, Touching& out) const;
    std::pair<const Point*, bool> point_for(const ManifoldPoint& p, const lie::State& x,
                                            const Manifold& manifold, unsigned taken) const;
    template <class F>
    auto named(const lie::State& x, const F& f) const;
    ContactCounts counts(const lie::State& x, Counted which, std::span<const int> of_body) const;

    const dae::Model& model;
    std::vector<std::unique_ptr<Point>> point;  ///< Manifold::most places for the histories of points
    double reach_i, reach_j;                    ///< see reach_about_centre()
};

}  // namespace hilda::contact
