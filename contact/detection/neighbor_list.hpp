// SPDX-License-Identifier: GPL-3.0-or-later
/// Neighbour list for many bodies of a few types.

#pragma once

#include "contact/compliant/contact.hpp"
#include "contact/detection/broad_phase.hpp"

#include <algorithm>
#include <limits>
#include <memory>

namespace hilda::contact {

/// Properties shared by bodies of one type
struct BodyType {
    Inertia inertia;
    Shape shape;
    /// Radius of the bounding sphere about the centre of mass [m]. It is infinite for an unbounded body
    /// such as a floor or a bowl. Two unbounded bodies do not interact.
    double reach = std::numeric_limits<double>::infinity();
};

/// The pairs of bodies that may be in contact (Verlet list).
///
/// `Law` holds the constant data of two body types and is set before the run. `State` holds the data of
/// one pair from step to step. It is State() when the pair enters the list, and it is deleted when the
/// pair leaves the list. The list is rebuilt when a bounded body has moved by half the skin. It is sorted
/// by the smaller body number of a pair, then by the larger one.
template <class Law, class State>
class NeighborList {
public:
    struct Pair {
        const Law* law;
        int i, j;  ///< body numbers, in the order in which set_law() received the types
        State state = {};
    };

    double skin = 0.1;  ///< distance of the bounding spheres of the pairs at a rebuild, by the smallest reach

    /// Adds a body type and returns its number. Throws lie::InvalidInput unless the reach is positive.
    int add_type(const BodyType& type)
    {
        if (!(type.reach > 0))
            lie::reject("contact::NeighborList", "the reach of a body type must be positive", type.reach);
        types.push_back(type);
        laws.resize(types.size());
        for (auto& row : laws) row.resize(types.size());
        return static_cast<int>(types.size()) - 1;
    }

    /// Throws lie::InvalidInput if there is no type k.
    const BodyType& body_type(int k) const
    {
        if (k < 0 || k >= static_cast<int>(types.size()))
            lie::reject("contact::NeighborList", "there is no body type with this number", k);
        return types[k];
    }

    /// Adds body b with type k. b must exceed the numbers of all bodies added before. Bodies that are not
    /// added have no type and are not in the list. Throws lie::InvalidInput if there is no type k.
    void add_body(int b, int k)
    {
        type_of.resize(b, none);
        reach.resize(b, -1);
        type_of.push_back(k);
        reach.push_back(body_type(k).reach);
        is_current = false;
    }

    /// Sets the law of a pair of types, which may be equal. Bodies whose types have no law do not interact.
    /// Throws lie::InvalidInput if both types are unbounded or if the pair has a law already.
    void set_law(int type_i, int type_j, std::unique_ptr<const Law> law)
    {
        if (std::isinf(body_type(type_i).reach) && std::isinf(body_type(type_j).reach))
            lie::reject("contact::NeighborList",
                        "one of the two body types of a law must have a finite reach",
                        body_type(type_i).reach);
        if (laws[type_i][type_j] != nullptr || laws[type_j][type_i] != nullptr)
            lie::reject("contact::NeighborList",
                        "a pair of body types must have one law only; law set again for type", type_j);
        laws[type_i][type_j] = std::move(law);
        is_current = false;
    }

    /// The pairs at these poses; the list is rebuilt if necessary. `body` holds all bodies of the system.
    /// Throws lie::NumericalFailure "nonfinite" if the position of a bounded body is not finite.
    std::vector<Pair>& find(const std::vector<Motion>& body)
    {
        if (needs_update(body)) update(body);
        return pairs;
    }

    const std::vector<Pair>& pair() const { return pairs; }  ///< the pairs of the last find()

    /// The pairs at these poses, with new states. The list does not change. For checks before a run.
    std::vector<Pair> pairs_near(const std::vector<Motion>& body) const
    {
        std::vector<Pair> out;
        BroadPhase once;
        std::vector<Vec3> at;
        for (size_t b = 0; b < reach.size(); ++b) at.push_back(body[b].r);
        for (const Candidate& c : once.find(at, reach, skin_length()))
            if (const Pair p = pair_of(c); p.law != nullptr) out.push_back(p);
        return out;
    }

private:
    static constexpr int none = -1;

    Pair pair_of(const Candidate& c) const
    {
        const int i = type_of[c.i], j = type_of[c.j];
        if (laws[i][j] != nullptr) return {.law = laws[i][j].get(), .i = c.i, .j = c.j};
        return {.law = laws[j][i].get(), .i = c.j, .j = c.i};
    }

    double skin_length() const
    {
        double smallest = std::numeric_limits<double>::infinity();
        for (const BodyType& k : types) smallest = std::min(smallest, k.reach);
        return std::isfinite(smallest) ? skin * smallest : 0;
    }

    bool needs_update(const std::vector<Motion>& body) const
    {
        if (types.empty()) return false;
        if (!is_current) return true;
        const double half = 0.5 * skin_length();
        for (size_t b = 0; b < reference_position.size(); ++b)
            if (std::isfinite(reach[b]) && reach[b] > 0 &&
                !((body[b].r - reference_position[b]).squaredNorm() < half * half))
                return true;
        return false;
    }

    void update(const std::vector<Motion>& body)
    {
        reference_position.clear();
        for (size_t b = 0; b < reach.size(); ++b) reference_position.push_back(body[b].r);
        is_current = false;  // if the search throws
        const auto& candidates = broad_phase.find(reference_position, reach, skin_length());
        is_current = true;

        previous.swap(pairs);
        pairs.clear();
        auto old = previous.begin();
        const auto lower = [](const Pair& p) { return std::pair(std::min(p.i, p.j), std::max(p.i, p.j)); };
        for (const Candidate& c : candidates) {
            Pair now = pair_of(c);
            if (now.law == nullptr) continue;
            while (old != previous.end() && lower(*old) < std::pair(c.i, c.j)) ++old;
            if (old != previous.end() && lower(*old) == std::pair(c.i, c.j))
                now.state = std::move(old->state);
            pairs.push_back(std::move(now));
        }
    }

    std::vector<BodyType> types;
    std::vector<std::vector<std::unique_ptr<const Law>>> laws;
    std::vector<int> type_of;   // type of each body, or none
    std::vector<double> reach;  // of each body [m], negative for bodies without a type
    std::vector<Vec3> reference_position;
    bool is_current = false;  // whether the list is that of the reference positions
    BroadPhase broad_phase;
    std::vector<Pair> pairs, previous;
};

}  // namespace hilda::contact
