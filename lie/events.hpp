// SPDX-License-Identifier: GPL-3.0-or-later
/// Events: zeros of scalar functions of the state, located between two nodes of a run.

#pragma once

#include "lie/state.hpp"

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace hilda::lie {

class Integrator;

struct Event {
    enum Direction { both, rising, falling };

    std::string name;
    std::function<double(const State&)> value;  ///< g(x)
    Direction direction = both;                 ///< sign of dg/dt of the zeros that count
    bool stops = false;                         ///< ends the run
};

/// A zero of the function of an event
struct EventFound {
    std::size_t event;  ///< index in the list of events
    bool rises;         ///< dg/dt > 0
    const State& x;     ///< complete, without history
};

/// Finds the events of a run from node to node: a change of the sign of g between two nodes, and its time by
/// partial steps from the first of them, to the last digits of t. Two zeros of one function between two nodes
/// are not seen. A function that is zero at a node has an event there, whether it changes its sign or touches
/// zero; not at the first node. A function that is not a number at a node and has changed its sign at the
/// next one throws NumericalFailure "event_not_finite".
///
/// A partial step starts without the history of a multi-step scheme; the state of an event has the local
/// accuracy of one step. With adaptive steps it is that of an output row at this time.
class EventSearch {
public:
    /// `make` constructs an integrator with the scheme and the settings of the run. A new one for each step
    /// with an event makes its digits independent of the steps before.
    using Make = std::function<std::unique_ptr<Integrator>()>;
    /// The values of all functions, where they are computed together; otherwise one by one
    using Values = std::function<void(const State& x, std::vector<double>& g)>;
    EventSearch(std::vector<Event> events, Make make, Values values = nullptr);
    ~EventSearch();

    using Report = std::function<void(const EventFound&)>;
    /// Takes the next node of the run, which is complete. Reports the events after the last node up to this
    /// one, in the order of time; those of equal times in the order of the list. Returns whether one of them
    /// stops the run: it is the last one that is reported. Throws NumericalFailure if a partial step fails.
    bool node(const State& x, const Report& report);

    const std::vector<Event>& events() const { return all; }
    /// Number and state of the event that stops the run, after node() has returned true
    std::size_t stopping() const { return zeros[stop].event; }
    const State& stopped() const { return x; }
    /// Whether g of an event was finite at one node at least
    bool was_finite(std::size_t event) const { return saved.sign[event] != unknown; }

    /// What a resumed run needs
    struct Saved {
        State node;             ///< the last one; without bodies before the first node
        std::vector<int> sign;  ///< of each g at that node: -1, 0, 1, or unknown
        /// Time of the first node at which each g was not a number [s]; NaN if there was none
        std::vector<double> undefined;
    };
    static constexpr int unknown = 2;
    Saved saved;

private:
    struct Zero {
        double tau;  ///< after the last node [s]
        std::size_t event;
        bool rises;
    };
    double locate(const Event& event, double g_begin, double g_end, double h);
    void set_state(double tau, double h);
    void set_state_of(const Zero& zero, const State& to, double h);

    void set_values(const State& at);

    const std::vector<Event> all;
    const Make make;
    const Values values;
    std::unique_ptr<Integrator> integrator;
    std::vector<double> g;  ///< at the last node
    std::vector<double> next_g;
    std::vector<int> next_sign;
    std::vector<Zero> zeros;
    std::vector<State> states;  ///< at the zeros up to the one that stops
    std::size_t stop = 0;
    State x, after;  ///< workspace: the state at an event, the step after it
};

}  // namespace hilda::lie
