// SPDX-License-Identifier: GPL-3.0-or-later
/// Event-driven time stepping with unilateral contacts: lift-off, flight, impact, fallback.

#pragma once

#include "contact/detection/passage.hpp"
#include "contact/evolving/contact.hpp"
#include "dae/model.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/solver/saddle.hpp"

namespace hilda::contact {

/// Event of a contact: its type, its time and the approach speed.
struct ContactEvent {
    enum class Type {
        /// active to inactive: the normal force, or the normal impulse in the impact of another contact,
        /// would be tensile
        lift_off,
        impact,          ///< an impact with a rebound; the contact stays inactive
        closing,         ///< inactive to active
        fallback_active  ///< a compliant contact force replaces the constraint
    } type = Type::lift_off;
    double t = 0;     ///< [s]
    int contact = 0;  ///< index in Model::general_constraints()
    /// Approach speed of an impact, of a closing, or of an impact that switches to the fallback [m/s]; else 0
    double speed = 0;

    bool operator==(const ContactEvent&) const = default;
};

/// Integrator for models with contacts that can become inactive. It wraps any scheme that accepts evolving
/// contacts.
///
/// The constraint rows of an active contact are part of the equations. The rows of an inactive contact are
/// not; its variables α are the nearest points of the two surfaces and are updated after each step. If the
/// fallback of a contact is active, it stays active until the end of the run. The mode of each contact is
/// stored in State::discrete_state.
///
/// - Lift-off: if F_N < 0 at t_n, the contact becomes inactive and the step from t_n is computed without
///   it. If this holds for several contacts, the one with the most negative F_N becomes inactive first,
///   and the forces are computed again. The contact is thus active for up to one step too long, and F_N is
///   O(h) there. The resulting error of the motion is of second order. With ideal rolling it is of first
///   order, because the friction force is not O(h) at lift-off. The time reported is the zero of the
///   parabola through F_N at the last nodes.
/// - Impact: if a gap is negative at t_{n+1}, the step length for which it is zero is found by regula falsi
///   (Illinois variant). Every trial starts from t_n, or from the last event in the step. At zero gap the
///   velocities jump. The remaining part of the step follows.
/// - Impulses: the compression impulses make the velocities satisfy the rows of all active contacts,
///   including the new one, and of the other constraints. Newton's law then replaces the normal velocity
///   zero by v⁺ = -e v⁻. Poisson's law adds e times the normal impulse of compression. Another active
///   contact remains active if its normal impulse is not negative; otherwise it becomes inactive.
/// - Friction in impacts: a contact with ideal rolling has a tangential impulse that removes the slip,
///   because its rolling rows are satisfied after the impact. For example, a solid sphere that lands
///   without spin keeps 5/7 of its tangential velocity. It rolls in compression and restitution. By Newton's
///   law such an impact can supply energy (Kane 1984) if the normal does not point to the centre of mass;
///   v⁺ is then reduced to the value that conserves the energy. The regularised rows of implicit friction and
///   tracked friction forces have no impulse.
/// - Closing: the contact becomes active if e = 0, if the time of flight after the rebound would be shorter
///   than a step, or if its last rebound was less than a step ago.
/// - Fallback at an impact: the multiplier of the contact may not be determined together with those of the
///   active constraints. The contact then switches to its fallback. Without a fallback the step throws
///   lie::NumericalFailure "contact_rank".
/// - Fallback after a failure: if a step fails, one contact switches to its fallback and the step is
///   repeated. It is the active contact with a fallback for which the smaller eigenvalue of K_i + K_j,
///   times L, is least.
///
/// The scheme restarts from the node of each event, and its multi-step history is discarded. rA-half-1
/// takes v_0 as v_{-½}. At each restart its velocity therefore has an error of the order of h times the
/// acceleration.
///
/// Limitations: contacts that close at the same time are treated one after the other. A gap that closes
/// and opens again within one step is not detected. A contact with its third impact in one step stays
/// active until the end of the step. This happens, for example, to a ball that strikes the two walls of a
/// narrowing groove in turn.
class UnilateralStep final : public lie::Integrator {
public:
    /// The model must outlive the integrator.
    UnilateralStep(const dae::Model& model, const lie::Scheme& scheme, const lie::Settings& settings);

    /// Throws lie::NumericalFailure "too_many_impacts" if the step has more events than the internal
    /// limit, and the exceptions of the scheme.
    int step(lie::State& x, double h) override;
    bool is_staggered() const override { return scheme->is_staggered(); }
    void fill_node(lie::State& node, const lie::State& after) const override;
    bool keeps_history() const override { return scheme->keeps_history(); }
    const lie::State* pivots() const override { return scheme->pivots(); }
    void choose_pivots(const lie::State& x, double h) override { scheme->choose_pivots(x, h); }
    const lie::System& system() const override { return model; }
    lie::Statistics statistics() const override { return scheme->statistics(); }

    /// All events so far, in the order in which they were detected. The times of lift-offs that are
    /// detected at the same node need not be ascending.
    const std::vector<ContactEvent>& events() const { return event_log; }

    /// Time [s] of a node at which a contact was active, and its normal force [N]. t is NaN if there is no
    /// such node.
    struct NodeForce {
        double t = std::numeric_limits<double>::quiet_NaN(), F_N = 0;
    };
    /// What the integrator stores in addition to the State; needed by checkpoints
    struct History {
        std::vector<ContactEvent> events;
        /// The previous and the last node of each contact that can become inactive, for lift_off_time()
        std::vector<NodeForce> node_forces;
    };
    History history() const;
    /// Throws lie::InvalidInput if the number of contacts differs.
    void restore(const History& saved);

private:
    static constexpr int max_impacts = 3;  ///< of one contact in one step
    /// A tensile force is noticeable above this value times the largest force, and an approach in one step
    /// above this value times L.
    static constexpr double rounding = 1e-9;

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
        return mode(c, x) == EvolvingContact::inactive;
    }
    static bool is_active(const TrackedContact& c, const lie::State& x)
    {
        return mode(c, x) == EvolvingContact::active;
    }
    double force(const TrackedContact& c, const lie::State& x, const Eigen::VectorXd& lambda) const;
    double gap(const TrackedContact& c, const lie::State& x) const;
    double separation_speed(const TrackedContact& c, const lie::State& x) const;
    bool overlaps(const TrackedContact& c, const lie::State& x) const;
    Passage passage(const TrackedContact& c, const lie::State& from, const lie::State& to) const;
    void update_alpha(const lie::State& from, lie::State& to) const;

    int advance(lie::State& x, double h);
    int try_step(const lie::State& from, lie::State& to, double h);
    void restart(lie::State& x);
    bool deactivate_tensile(lie::State& x);
    TrackedContact* first_to_close(const lie::State& from, const lie::State& to);
    double first_passage(const lie::State& from, const lie::State& to) const;
    double find_closing(const lie::State& from, lie::State& to, double h, TrackedContact*& first);
    double find_zero_gap(const TrackedContact& c, const lie::State& from, lie::State& to, double h);
    void resolve_impact(lie::State& x, TrackedContact& c, double h);
    EvolvingContact::Multipliers impulse(const TrackedContact& c, const lie::State& x) const;
    double rolling_rebound(const TrackedContact& c, const EvolvingContact::Multipliers& compressed,
                           const EvolvingContact::Multipliers& rebounded, double rebound) const;
    bool force_is_determined(const TrackedContact& c, lie::State& x);
    std::string names_of_active(const lie::State& x) const;
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
    lie::State step_start;    ///< state from which the current attempt of the step starts
    lie::State at_entry;      ///< state at the call of step(), if the step is repeated with a fallback
    lie::State trial;         ///< end of a part of the step
    lie::State full_node;     ///< node at t_n, completed by fill_node(), without a history
    lie::State restart_node;  ///< the same for the beginning of a later part
    lie::State before_impact;
    /// Impulse that the next velocity jump adds, 6 numbers per body: linear impulse [N s, global frame] and
    /// angular impulse [N m s, body frame]
    Eigen::VectorXd momentum;
    Eigen::VectorXd v;  ///< right side and solution of a velocity jump
};

/// The integrator of a scheme for this model, wrapped by UnilateralStep if a contact of the model can become
/// inactive
std::unique_ptr<lie::Integrator> make_integrator(const dae::Model& model, const lie::Scheme& scheme,
                                                 const lie::Settings& settings);

}  // namespace hilda::contact
