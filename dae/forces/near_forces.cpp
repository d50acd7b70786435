// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/forces/near_forces.hpp"

#include "lie/check.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace hilda::dae {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double skin = 0.15;        // radius of the sphere of a body at rest, relative to its reach
constexpr double largest_skin = 10;  // the same, relative to the skin of the smallest body
constexpr double steps_ahead = 2;    // steps with the present velocity that the sphere contains
constexpr double growth = 1.25;      // of the number of places
constexpr long most_numbers = std::numeric_limits<int>::max() / 2;

/// Bound of the distance of a body from the middle of its ends over a step: the control polygon of its cubic
double length_of_path(const Motion& begin, const Motion& end, double h)
{
    const Vec3 v = h / 3 * begin.rdot, w = h / 3 * end.rdot;
    return v.norm() + (end.r - begin.r - v - w).norm() + w.norm();
}

}  // namespace

const std::shared_ptr<const Force>* NearForces::List::find(int number) const
{
    const auto at = std::lower_bound(entry.begin(), entry.end(), number,
                                     [](const Entry& e, int n) { return e.number < n; });
    return at != entry.end() && at->number == number ? &at->force : nullptr;
}

void NearForces::add(std::unique_ptr<ForceGroup> group)
{
    if (first.back() > most_numbers - group->numbers())
        lie::reject(group->example().label(),
                    "the groups of contacts may have at most " + std::to_string(most_numbers) +
                        " numbers of pairs; got",
                    static_cast<long>(first.back()) + group->numbers());
    first.push_back(first.back() + group->numbers());
    states = std::max(states, group->example().internal_states());
    groups.push_back(std::move(group));
}

long NearForces::pairs() const
{
    long sum = 0;
    for (const auto& g : groups) sum += g->pairs();
    return sum;
}

std::pair<const ForceGroup*, int> NearForces::group_of(int number) const
{
    const auto k =
        static_cast<std::size_t>(std::upper_bound(first.begin(), first.end(), number) - first.begin() - 1);
    return {groups.at(k).get(), number - first[k]};
}

std::shared_ptr<Force> NearForces::make(int number, int place) const
{
    const auto [group, pair] = group_of(number);
    std::shared_ptr<Force> force = group->force(pair);
    force->first_discrete_state = first_discrete(place) + 1;
    force->first_internal_state = first_internal(place);
    return force;
}

std::shared_ptr<const Force> NearForces::force(int number) const { return make(number, 0); }

void NearForces::set_layout(int of_bodies, int of_discrete, int of_internal)
{
    bodies = of_bodies, discrete = of_discrete, internal = of_internal;
    reach.assign(static_cast<std::size_t>(bodies), -1);
    for (int b = 0; b < bodies; ++b)
        for (const auto& g : groups) {
            double& of = reach[static_cast<std::size_t>(b)];
            if (const double r = g->reach(b); r >= 0) of = of < 0 ? r : std::min(of, r);
        }
}

int NearForces::places(const State& x) const
{
    return (static_cast<int>(x.discrete_state.size()) - discrete) / 2;
}

bool NearForces::fits(const State& x) const
{
    const int n = places(x);
    if (n < 1 || static_cast<int>(x.discrete_state.size()) != first_discrete(n) ||
        static_cast<int>(x.internal_state.size()) != first_internal(n) || x.discrete_state[discrete] != 0)
        return false;
    std::vector<int> numbers;
    for (int k = 1; k < n; ++k) {
        const int number = x.discrete_state[first_discrete(k)] - 1;
        if (number < 0) continue;
        if (number >= this->numbers()) return false;
        const auto [group, pair] = group_of(number);
        if (!group->has_pair(pair)) return false;
        numbers.push_back(number);
    }
    std::sort(numbers.begin(), numbers.end());
    return std::adjacent_find(numbers.begin(), numbers.end()) == numbers.end();
}

bool NearForces::is_within_spheres(const State& x) const
{
    const double* at = x.internal_state.data() + internal;
    for (const Motion& body : x.body) {
        if (!((body.r - Vec3::Map(at)).squaredNorm() <= at[3] * at[3])) return false;
        at += 4;
    }
    return true;
}

/// The list of State::derived, or nullptr
std::shared_ptr<const NearForces::List> NearForces::derived(const State& x) const
{
    std::shared_ptr<const List> known = std::static_pointer_cast<const List>(x.derived);
    return known != nullptr && known->owner == this ? known : nullptr;
}

const NearForces::List* NearForces::current(const State& x) const
{
    const auto* known = static_cast<const List*>(x.derived.get());
    return known != nullptr && known->owner == this && is_within_spheres(x) ? known : nullptr;
}

std::shared_ptr<NearForces::List> NearForces::empty_list() const
{
    auto made = std::make_shared<List>();
    made->owner = this;
    std::atomic_ref(lists_made).fetch_add(1, std::memory_order_relaxed);
    return made;
}

std::shared_ptr<const NearForces::List> NearForces::restored(const State& x) const
{
    auto made = empty_list();
    for (int k = 1; k < places(x); ++k)
        if (const int number = x.discrete_state[first_discrete(k)] - 1; number >= 0)
            made->entry.push_back({number, make(number, k)});
    std::sort(made->entry.begin(), made->entry.end(),
              [](const List::Entry& a, const List::Entry& b) { return a.number < b.number; });
    return made;
}

std::shared_ptr<const NearForces::List> NearForces::list(const State& x) const
{
    std::shared_ptr<const List> known = derived(x);
    if (known == nullptr) known = restored(x);
    if (is_within_spheres(x)) return known;
    // Pairs that are in no list have not been in contact: they have the states of a start.
    std::vector<int> numbers;
    find(x.body, std::vector<double>(x.body.size(), 0.), numbers);
    auto made = empty_list();
    for (const int n : numbers) {
        const std::shared_ptr<const Force>* old = known->find(n);
        made->entry.push_back({n, old != nullptr ? *old : make(n, 0)});
    }
    return made;
}

void NearForces::find(const std::vector<Motion>& body, const std::vector<double>& motion,
                      std::vector<int>& numbers) const
{
    numbers.clear();
    std::vector<int> of_group;
    for (std::size_t g = 0; g < groups.size(); ++g) {
        groups[g]->find(body, motion, of_group);
        for (const int n : of_group) numbers.push_back(first[g] + n);
    }
}

/// Radii of the spheres of the bodies, for steps h that follow
std::vector<double> NearForces::radii(const State& x, double h) const
{
    double smallest = infinite;
    for (const double r : reach)
        if (r > 0) smallest = std::min(smallest, r);
    std::vector<double> radius;
    for (std::size_t b = 0; b < x.body.size(); ++b) {
        const double r = reach[b];
        radius.push_back(r < 0 || std::isinf(r) ? infinite
                                                : skin * std::min(r, largest_skin * smallest) +
                                                      steps_ahead * std::abs(h) * x.body[b].rdot.norm());
    }
    return radius;
}

void NearForces::set_spheres(State& x, const std::vector<Motion>& about,
                             const std::vector<double>& radius) const
{
    double* at = x.internal_state.data() + internal;
    for (std::size_t b = 0; b < about.size(); ++b, at += 4) {
        Vec3::Map(at) = about[b].r;
        at[3] = radius[b];
    }
}

std::shared_ptr<const NearForces::List> NearForces::found(const State& x) const
{
    std::vector<int> numbers;
    find(x.body, radii(x, 0), numbers);
    auto made = empty_list();
    for (const int n : numbers) made->entry.push_back({n, make(n, 0)});
    return made;
}

void NearForces::start(State& x) const
{
    const std::vector<double> radius = radii(x, 0);
    std::vector<int> numbers;
    find(x.body, radius, numbers);
    const int n = 1 + static_cast<int>(numbers.size());
    x.discrete_state.resize(static_cast<std::size_t>(discrete));
    x.internal_state.resize(static_cast<std::size_t>(internal));
    x.discrete_state.resize(static_cast<std::size_t>(first_discrete(n)), 0);
    x.internal_state.resize(static_cast<std::size_t>(first_internal(n)), 0.);
    set_spheres(x, x.body, radius);
    for (int k = 1; k < n; ++k) x.discrete_state[first_discrete(k)] = 1 + numbers[k - 1];
    x.derived = restored(x);
}

void NearForces::restart(State& x) const
{
    if (current(x) == nullptr) return start(x);
    for (int k = 0; k < places(x); ++k) x.discrete_state[first_discrete(k) + 1] = 0;
    std::fill(x.internal_state.begin() + first_internal(0), x.internal_state.end(), 0.);
}

bool NearForces::is_kept(const State& before, const State& after) const
{
    return derived(before) != nullptr && after.derived == before.derived && is_within_spheres(after);
}

void NearForces::renew(State& before, State& after) const
{
    const double h = after.t - before.t;
    std::shared_ptr<const List> known = derived(before);
    if (known == nullptr) known = restored(before);
    const std::vector<double> radius = radii(after, h);
    std::vector<int> near, met, numbers;
    find(after.body, radius, near);
    // the pairs that met within the step, also if they are apart at its end
    std::vector<Motion> middle(after.body.size());
    std::vector<double> path(after.body.size());
    for (std::size_t b = 0; b < middle.size(); ++b) {
        middle[b].r = 0.5 * (before.body[b].r + after.body[b].r);
        path[b] = length_of_path(before.body[b], after.body[b], h);
    }
    find(middle, path, met);
    std::set_union(near.begin(), near.end(), met.begin(), met.end(), std::back_inserter(numbers));

    // places of pairs that leave become free
    for (State* x : {&before, &after})
        for (const List::Entry& e : known->entry)
            if (!std::binary_search(numbers.begin(), numbers.end(), e.number)) {
                const int k = place(*e.force);
                x->discrete_state[first_discrete(k)] = x->discrete_state[first_discrete(k) + 1] = 0;
                std::fill_n(x->internal_state.begin() + first_internal(k), states, 0.);
            }
    const int needed = 1 + static_cast<int>(numbers.size()), have = places(before);
    if (needed > have) {
        const int n = std::max(needed, static_cast<int>(growth * have));
        for (State* x : {&before, &after}) {
            x->discrete_state.resize(static_cast<std::size_t>(first_discrete(n)), 0);
            x->internal_state.resize(static_cast<std::size_t>(first_internal(n)), 0.);
        }
    }
    for (State* x : {&before, &after}) set_spheres(*x, after.body, radius);

    const std::shared_ptr<List> next = empty_list();
    next->entry.reserve(numbers.size());
    auto old = known->entry.begin();
    int free = 0;
    for (const int n : numbers) {
        while (old != known->entry.end() && old->number < n) ++old;
        if (old != known->entry.end() && old->number == n) {
            next->entry.push_back(*old);
            continue;
        }
        do ++free;
        while (before.discrete_state[first_discrete(free)] != 0);
        const std::shared_ptr<Force> force = make(n, free);
        before.discrete_state[first_discrete(free)] = after.discrete_state[first_discrete(free)] = n + 1;
        force->update_internal_state(before);
        after.discrete_state[first_discrete(free) + 1] = before.discrete_state[first_discrete(free) + 1];
        std::copy_n(before.internal_state.begin() + first_internal(free), states,
                    after.internal_state.begin() + first_internal(free));
        next->entry.push_back({n, force});
    }
    before.derived = after.derived = next;
}

}  // namespace hilda::dae
