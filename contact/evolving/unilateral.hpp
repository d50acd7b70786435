// SPDX-License-Identifier: GPL-3.0-or-later
/// Event-driven time stepping with unilateral contacts: lift-off, flight, impact, fallback.

#pragma once

#include "contact/evolving/contact.hpp"
#include "dae/model.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/solver/saddle.hpp"

namespace hilda::contact {

/// Event of a contact: its type, time, and approach speed.
struct ContactEvent {
    enum class Type {
        lift_off,        ///< active to inactive, the normal force became negative
        impact,          ///< an impact with a rebound; the contact stays inactive
        closing,         ///< inactive to active
        fallback_active  ///< a compliant contact force replaces the constraint
    } type = Type::lift_off;
    double t = 0;      ///< [s]
    int contact = 0;   ///< index in Model::evolving()
    double speed = 0;  ///< approach speed of an impact or a closing [m/s], else 0

    bool operator==(const ContactEvent&) const = default;
};

/// Integrator for models with contacts that can become inactive. It wraps any scheme that accepts evolving
/// contacts.
///
/// An active contact has its constraint rows in force. For an inactive contact the nearest points of the two
/// surfaces are tracked. A contact whose fallback is active stays so until the end of the run. The mode of
/// each contact is stored in State::discrete_state.
///
/// - Lift-off: if F_N < 0 at t_n, the step from t_n is repeated without the contact, the most negative one
///   first. Up to then the contact was active with F_N = O(h), so the motion after lift-off is of second
///   order. With rolling it is of first order, because the friction is finite at lift-off. The time reported
///   is the zero of the parabola through F_N at the last nodes.
/// - Impact: if a gap is negative at t_{n+1}, the step length at which it is zero is found by regula falsi
///   (Illinois variant); every trial starts from t_n. The velocities jump there and the rest of the step
///   follows.
/// - Impulses: the compression makes all active contacts and the other constraints hold after the impact.
///   Newton's law then prescribes the normal velocity v⁺ = -e v⁻; Poisson's law adds e times the normal
///   impulse of compression. Other active contacts remain active if their normal impulse is not negative;
///   else they become inactive.
/// - Friction in impacts: the rows of ideal rolling take part, so a contact with ideal rolling has a
///   tangential impulse that removes the slip (a sphere that lands without spin keeps 5/7 of its tangential
///   velocity). Regularised rows of implicit friction and tracked friction forces have no impulse.
/// - Closing: the contact becomes active if e = 0, if the time of flight after the rebound would be shorter
///   than a step, or if its last rebound was less than a step ago.
/// - Fallback, if the contact has one: a contact whose multiplier is not determined together with those of
///   the active constraints at its impact switches to it; without a fallback this is lie::NumericalFailure
///   "contact_rank". If a step fails, the active contact with the smallest K_i + K_j that has a fallback
///   switches to it, and the step is repeated.
///
/// The scheme restarts from the node of each event; its multi-step history is discarded. rA-half-1, which
/// takes v_0 as v_{-½}, has at each restart an error of the velocity of about h times the acceleration.
///
/// Limitations: contacts that close at the same time are treated one after the other. A gap that closes and
/// opens again within one step is not detected. A contact with its third impact in one step (for example
/// alternating impacts on the two walls of a groove) stays active until the end of the step.
class UnilateralStep final : public lie::Integrator {
public:
    /// The model must outlive the integrator.
    UnilateralStep(const dae::Model& model, const lie::Scheme& scheme, const lie::Settings& settings);

    int step(lie::State& x, double h) override;
    bool is_staggered() const override { return scheme->is_staggered(); }
    void fill_node(lie::State& node, const lie::State& after) const override;
    bool keeps_history() const override { return scheme->keeps_history(); }
    const lie::State* pivots() const override { return scheme->pivots(); }
    void choose_pivots(const lie::State& x) override { scheme->choose_pivots(x); }
    const lie::System& system() const override { return model; }
    lie::Statistics statistics() const override { return scheme->statistics(); }

    /// All events so far, in order of time
    const std::vector<ContactEvent>& events() const { return event_log; }

    /// Normal force of an active contact at a node [s, N]; t is NaN if there is none.
    struct NodeForce {
        double t = std::numeric_limits<double>::quiet_NaN(), F_N = 0;
    };
    /// What the integrator stores in addition to the State; needed by checkpoints
    struct History {
        std::vector<ContactEvent> events;
        std::vector<NodeForce>
            node_forces;  ///< the last two of each contact that can become inactive; for lift_off_time()
    };
    History history() const;
    void restore(const History& saved);  ///< lie::InvalidInput if the number of contacts differs

private:
    static constexpr int max_impacts = 3;  ///< of one contact in one step
    static constexpr double rounding =
        1e-9;  ///< relative to the largest force; also to L, for the approach in one step

    struct TrackedContact {
        const EvolvingContact* contact;
        int number;
        NodeForce last_node = {}, previous_node = {};
        int impacts = 0;                 ///< in the current step
        bool stays_active = false;       ///< until the end of the current step
        bool fallback_reported = false;  ///< the fallback is active and its event is in the log

        void record(double t, double F_N);
        double lift_off_time(double t, double F_N) const;
    };

    static int mode(const TrackedContact& c, const lie::State& x) { return dae::Model::mode(*c.contact, x); }
    static bool is_inactive(const TrackedContact& c, const lie::State& x)
    {
        return mode(c, x) == dae::Constraint::inactive;
    }
    static bool is_active(const TrackedContact& c, const lie::State& x)
    {
        return mode(c, x) == dae::Constraint::active;
    }
    double force(const TrackedContact& c, const lie::State& x, const Eigen::VectorXd& lambda) const;
    double gap(const TrackedContact& c, const lie::State& x) const;
    double separation_speed(const TrackedContact& c, const lie::State& x) const;
    bool overlaps(const TrackedContact& c, const lie::State& x) const;
    void update_alpha(lie::State& x) const;

    int advance(lie::State& x, double h);
    int try_step(const lie::State& from, lie::State& to, double h);
    void restart(lie::State& x);
    bool deactivate_tensile(lie::State& x);
    TrackedContact* first_to_close(const lie::State& from, const lie::State& to);
    double find_closing(lie::State& to, double h, TrackedContact*& first);
    double find_zero_gap(const TrackedContact& c, lie::State& to, double h);
    void resolve_impact(lie::State& x, TrackedContact& c, double h);
    bool force_is_determined(const TrackedContact& c, lie::State& x);
    void switch_to_fallback(const TrackedContact& c, lie::State& x, double speed);
    bool switch_least_curved_to_fallback(lie::State& x);
    void report_fallbacks(const lie::State& x);
    void solve_velocity_jump(lie::State& x, const TrackedContact* rebounding, double speed);
    void add_impulse(const TrackedContact& c, double impulse, const lie::State& x);

    const dae::Model& model;
    std::unique_ptr<lie::Integrator> scheme;
    lie::Saddle K;  ///< saddle matrix of impacts and restarts
    std::vector<TrackedContact> contact;
    std::vector<ContactEvent> event_log;
    lie::State at_entry;                  ///< state at the call of step(); restored if the step fails
    lie::State step_start;                ///< state from which the current attempt of the step starts
    lie::State node, trial;               ///< begin and end of a part of the step
    lie::State restart_node;              ///< `node` filled in (see fill_node()), without a history
    lie::State full_node, before_impact;  ///< t_n, filled in (see fill_node()); state before an impact
    /// Impulse that the next velocity jump adds: 6 numbers per body, global force and body-frame torque part
    Eigen::VectorXd momentum;
    Eigen::VectorXd v;  ///< right side and solution of a velocity jump
};

/// The integrator of a scheme for this model, wrapped by UnilateralStep if a contact of the model can become
/// inactive
std::unique_ptr<lie::Integrator> make_integrator(const dae::Model& model, const lie::Scheme& scheme,
                                                 const lie::Settings& settings);

}  // namespace hilda::contact
