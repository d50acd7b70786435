// SPDX-License-Identifier: GPL-3.0-or-later
/// The forces of the groups of a model between pairs of bodies that are close to each other.

#pragma once

#include "dae/forces/force_group.hpp"
#include "lie/state.hpp"

#include <memory>
#include <vector>

namespace hilda::dae {

/// The near pairs of a state (Verlet list). The list contains every pair whose bodies can touch while no body
/// leaves a sphere about a reference position. It is part of the state, so that the continuation of a state
/// depends on the state alone. It changes between two steps only, when a body has left its sphere.
///
/// The numbers of the list follow those of the other forces in the state:
///
///     discrete_state   for each place: number of its pair plus 1, or 0 for a free place; state of the force
///     internal_state   for each body: reference position (3) and radius of the sphere; for each place the
///                      states of the force
///
/// A pair keeps its place while it is in the list. Place 0 is always free: its zeros are the states of a
/// force that is not in the list. State::derived contains the forces; forces of a state without it, such as
/// one from a checkpoint, are made again.
class NearForces {
public:
    /// The forces of the near pairs of a state, by ascending numbers
    struct List final : lie::DerivedLists {
        struct Entry {
            int number;
            std::shared_ptr<const Force> force;
        };
        const NearForces* owner = nullptr;  ///< a state may come from another model
        std::vector<Entry> entry;

        const std::shared_ptr<const Force>* find(int number) const;
    };

    void add(std::unique_ptr<ForceGroup> group);
    bool empty() const { return groups.empty(); }
    const std::vector<std::unique_ptr<ForceGroup>>& all_groups() const { return groups; }
    int first_number(std::size_t group) const { return first[group]; }  ///< of the pairs of a group
    int numbers() const { return first.back(); }                        ///< all numbers are below this
    long pairs() const;                                                 ///< of all groups

    /// The group of a pair, and the number of the pair in it
    std::pair<const ForceGroup*, int> group_of(int number) const;
    /// The force of a pair with the states of place 0
    std::shared_ptr<const Force> force(int number) const;

    /// Sets the number of bodies, and the sizes of both kinds of states without those of the list.
    void set_layout(int bodies, int discrete, int internal);
    /// Whether the states of x have the form of this class
    bool fits(const State& x) const;

    /// The pairs that are near at a start. Their forces have the states of place 0, which need not exist.
    std::shared_ptr<const List> found(const State& x) const;
    /// Appends the near pairs with states of zero to x, which has the states of the other forces.
    void start(State& x) const;
    /// Sets the states of all forces to zero, after start(). The list is renewed if the bodies have moved.
    void restart(State& x) const;
    /// Whether the list of `after`, which is that of `before`, can be kept after a step
    bool is_kept(const State& before, const State& after) const;
    /// Renews the list after a step from `before`. Both states receive the new list; new pairs have the
    /// states of a start at `before`. Pairs that met within the step are in it.
    void renew(State& before, State& after) const;

    /// Place of a force of the list of a state
    int place(const Force& force) const { return (force.first_discrete_state - 1 - discrete) / 2; }
    /// The list of a state. If a body has left its sphere, the pairs that are near at x.
    std::shared_ptr<const List> list(const State& x) const;
    /// Calls f(force, number) for each near pair in x, by ascending numbers. It allocates memory only if a
    /// body has left its sphere or x has no State::derived.
    template <class F>
    void visit(const State& x, F f) const
    {
        if (empty()) return;
        if (const List* known = current(x); known != nullptr) {
            for (const List::Entry& e : known->entry) f(*e.force, e.number);
            return;
        }
        const std::shared_ptr<const List> made = list(x);
        for (const List::Entry& e : made->entry) f(*e.force, e.number);
    }

    /// Counts for tests of growth: lists made
    mutable long lists_made = 0;

private:
    std::shared_ptr<const List> derived(const State& x) const;
    std::shared_ptr<List> empty_list() const;
    const List* current(const State& x) const;
    bool is_within_spheres(const State& x) const;
    int places(const State& x) const;
    int first_discrete(int place) const { return discrete + 2 * place; }
    int first_internal(int place) const { return internal + 4 * bodies + states * place; }
    std::shared_ptr<Force> make(int number, int place) const;
    std::shared_ptr<const List> restored(const State& x) const;
    std::vector<double> radii(const State& x, double h) const;
    void find(const std::vector<Motion>& body, const std::vector<double>& motion,
              std::vector<int>& numbers) const;
    void set_spheres(State& x, const std::vector<Motion>& about, const std::vector<double>& radius) const;

    std::vector<std::unique_ptr<ForceGroup>> groups;
    std::vector<int> first = {0};  ///< first number of each group, then the end
    int bodies = 0, discrete = 0, internal = 0;
    int states = 0;             ///< internal states of a place
    std::vector<double> reach;  ///< smallest of each body over the groups; negative: in no group
};

}  // namespace hilda::dae
