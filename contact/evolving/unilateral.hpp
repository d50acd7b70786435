// SPDX-License-Identifier: GPL-3.0-or-later
/// Contacts that come and go while a scheme steps: lift-off, flight, impact.

#pragma once

#include "contact/evolving/contact.hpp"
#include "lie/integrator.hpp"

namespace hilda::contact {

/// What happened to a contact, and when
struct ContactEvent {
    enum class Type { lift_off, impact, closing, fallback_active } type = Type::lift_off;
    double t = 0;      ///< [s]
    int contact = 0;   ///< its number in Model::evolving()
    double speed = 0;  ///< of approach at an impact and a closing [m/s]

    bool operator==(const ContactEvent&) const = default;
};

/// Steps a model whose contacts may open, with any scheme that takes contacts that evolve.
///
/// A contact is closed, and its rows hold, or open, and its contact points are the nearest points of the two surfaces.
/// Which of them are open stands in State::memory.
///
/// - Lift-off: where F_N < 0 at t_n, the step from t_n is made again without that contact. It holds until then with
///   F_N of O(h), so that what follows is of second order; with rolling of first, for its friction is finite until then.
///   The time reported is where the parabola of F_N over the last nodes is 0.
/// - Flight: the nearest points are followed from node to node.
/// - Impact: where a gap would be negative at t_{n+1}, the instant at which it is zero is found (regula falsi on the
///   length of the step, started anew from t_n), the velocities jump there, and the rest of the step follows.
///   Normal impulses, without friction: Newton, v⁺ = -e v⁻ along the normal; Poisson, the impulse of compression, with
///   v = 0 after it, and e times it after that. Other closed contacts hold in an impact if they press, else they open.
/// - Handing over, where that is allowed: of a contact whose force would not be determined with those that are closed,
///   when it meets (else lie::NumericalFailure "contact_rank"); of the flattest contact, where a step fails.
/// - Closing: where e is 0, or where the rebound would be or was shorter than a step, the contact closes.
///
/// At each of them the scheme starts anew from the node: rA-half-1, which takes v_0 as v_{-½}, loses about h times the
/// acceleration of free flight with every impact. Impulses are without friction, also of contacts that roll; of contacts
/// that meet at once, one after the other.
///
/// A gap that closes and opens again within one step is not seen. A contact that meets for the third time in one step,
/// as in a groove whose walls it strikes in turns, ever more often, is held closed until the next.
class UnilateralStep final : public lie::Integrator {
public:
    /// The model and the scheme must outlive it.
    UnilateralStep(const dae::Model& model, const lie::Scheme& scheme, const lie::Settings& settings);

    int step(lie::State& x, double h) override;
    bool is_staggered() const override { return scheme->is_staggered(); }
    void fill_node(lie::State& node, const lie::State& after) const override;
    bool keeps_history() const override { return scheme->keeps_history(); }
    const lie::State* pivots() const override { return scheme->pivots(); }
    void choose_pivots(const lie::State& x) override { scheme->choose_pivots(x); }
    const lie::System& system() const override { return model; }
    lie::Statistics statistics() const override { return scheme->statistics(); }

    /// What happened so far, in order of time
    const std::vector<ContactEvent>& events() const { return happened; }

    /// A node at which a contact was closed; none where t is NaN
    struct Known {
        double t = std::numeric_limits<double>::quiet_NaN(), F_N = 0;
    };
    /// All that it knows and that does not stand in the state; for checkpoints
    struct Past {
        std::vector<ContactEvent> events;
        std::vector<Known>
            closed;  ///< of each contact that may open the last two, for the time of a lift-off
    };
    Past past() const;
    void go_on_from(const Past& past);  ///< InvalidInput for one of another number of contacts

private:
    static constexpr int most_meetings = 3;  ///< of a contact in one step
    static constexpr double rounding =
        1e-9;  ///< of the largest force, and of a size that is approached in a step

    struct TrackedContact {
        const EvolvingContact* contact;
        int number;
        Known last = {}, before = {};
        int closings = 0;   ///< in the step
        bool held = false;  ///< stays closed for the rest of the step
        bool gone = false;  ///< handed over, and told of

        void note(double t, double F_N);
        double lift_off(double t, double F_N) const;
    };

    static int mode(const TrackedContact& c, const lie::State& x) { return dae::Model::mode(*c.contact, x); }
    static bool open(const TrackedContact& c, const lie::State& x)
    {
        return mode(c, x) == dae::Constraint::inactive;
    }
    static bool closed(const TrackedContact& c, const lie::State& x)
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
    bool release_pulling(lie::State& x);
    TrackedContact* first_to_close(const lie::State& from, const lie::State& to);
    double find_closing(lie::State& to, double h, TrackedContact*& first);
    double zero_of_gap(const TrackedContact& c, lie::State& to, double h);
    void collide(lie::State& x, TrackedContact& c, double h);
    bool determined(const TrackedContact& c, lie::State& x);
    void hand_over(const TrackedContact& c, lie::State& x, double speed);
    bool hand_over_flattest(lie::State& x);
    void tell_of_handed_over(const lie::State& x);
    void jump(lie::State& x, const TrackedContact* rebounding, double speed);
    void push(const TrackedContact& c, double impulse, const lie::State& x);

    const dae::Model& model;
    std::unique_ptr<lie::Integrator> scheme;
    lie::Saddle K;  ///< for impacts and restarts
    std::vector<TrackedContact> contact;
    std::vector<ContactEvent> happened;
    lie::State first;          ///< the state to go back to where the step fails ...
    lie::State begin;          ///< of the step, to go back to
    lie::State node, trial;    ///< of a part of it, and where that leads
    lie::State anew;           ///< the node in full and without a history
    lie::State known, before;  ///< the node that the step left, in full; a state before it jumps
    Eigen::VectorXd momentum, v;
};

/// The scheme for this model: as it is, or within UnilateralStep where contacts of the model may open.
std::unique_ptr<lie::Integrator> make_integrator(const dae::Model& model, const lie::Scheme& scheme,
                                                 const lie::Settings& settings);

}  // namespace hilda::contact
