// SPDX-License-Identifier: GPL-3.0-or-later
/// Bodies of a few kinds of which any two may meet.

#pragma once

#include "contact/compliant/contact.hpp"
#include "contact/detection/broad_phase.hpp"

#include <algorithm>
#include <limits>
#include <memory>

namespace hilda::contact {

/// Bodies that are alike
struct BodyType {
    Inertia inertia;
    Shape shape;
    /// Radius of a ball about the centre of mass that holds the body [m]; infinite for what is big, such as a bowl or a
    /// floor. Big bodies do not meet each other.
    double reach = std::numeric_limits<double>::infinity();
};

/// Pairs of bodies that may touch, as they come near and part. A Law is what is constant of two kinds, made before a run; a
/// State is what a pair keeps from step to step, as long as it is a candidate, and begins as State(). Pairs are looked
/// for anew only when some body has moved by half the skin, and their order is that of the body numbers.
template <class Law, class State>
class NeighborList {
public:
    struct Pair {
        const Law* law;
        int i, j;  ///< in the order of the kinds of the law
        State state = {};
    };

    double margin = 0;  ///< Pairs nearer than this are in the list [m] ...
    double skin =
        0.1;  ///< ... and those that are no further off than this beyond it, over the smallest reach

    int add(const BodyType& kind)
    {
        if (!(kind.reach > 0))
            lie::reject("contact::Crowd", "the reach of a kind must be positive", kind.reach);
        kinds.push_back(kind);
        laws.resize(kinds.size());
        for (auto& row : laws) row.resize(kinds.size());
        return static_cast<int>(kinds.size()) - 1;
    }

    const BodyType& kind(int k) const
    {
        if (k < 0 || k >= static_cast<int>(kinds.size()))
            lie::reject("contact::Crowd", "no kind has this number", k);
        return kinds[k];
    }

    /// Body b, the last one there is, is of kind k.
    void enter(int b, int k)
    {
        kind_of.resize(b, none);
        reach.resize(b, -1);
        kind_of.push_back(k);
        reach.push_back(kind(k).reach);
        searched_at.clear();
    }

    /// What holds between two kinds, or among one; bodies of kinds that have no law pass through each other.
    void set(int kind_i, int kind_j, std::unique_ptr<const Law> law)
    {
        if (std::isinf(kind(kind_i).reach) && std::isinf(kind(kind_j).reach))
            lie::reject("contact::Crowd", "one of two kinds that meet must have a finite reach",
                        kind(kind_i).reach);
        if (laws[kind_i][kind_j] != nullptr || laws[kind_j][kind_i] != nullptr)
            lie::reject("contact::Crowd", "two kinds have one law, and these have it already; kind", kind_j);
        laws[kind_i][kind_j] = std::move(law);
        searched_at.clear();
    }

    /// The pairs of these bodies. lie::NumericalFailure "nonfinite" for a body that is nowhere.
    std::vector<Pair>& find(const std::vector<Motion>& body)
    {
        if (stale(body)) search(body);
        return pairs;
    }

    const std::vector<Pair>& pair() const { return pairs; }  ///< those of the last find()

    /// The same with nothing remembered and nothing kept: for a check before a run
    std::vector<Pair> near(const std::vector<Motion>& body) const
    {
        std::vector<Pair> out;
        BroadPhase once;
        std::vector<Vec3> at;
        for (size_t b = 0; b < reach.size(); ++b) at.push_back(body[b].r);
        for (const Candidate& c : once.find(at, reach, margin + skin_length()))
            if (const Pair p = pair_of(c); p.law != nullptr) out.push_back(p);
        return out;
    }

private:
    static constexpr int none = -1;

    Pair pair_of(const Candidate& c) const
    {
        const int i = kind_of[c.i], j = kind_of[c.j];
        if (laws[i][j] != nullptr) return {.law = laws[i][j].get(), .i = c.i, .j = c.j};
        return {.law = laws[j][i].get(), .i = c.j, .j = c.i};
    }

    double skin_length() const
    {
        double smallest = std::numeric_limits<double>::infinity();
        for (const BodyType& k : kinds) smallest = std::min(smallest, k.reach);
        return std::isfinite(smallest) ? skin * smallest : 0;
    }

    bool stale(const std::vector<Motion>& body) const
    {
        if (kinds.empty()) return false;
        if (searched_at.empty() || margin != searched_margin) return true;
        const double half = 0.5 * skin_length();
        for (size_t b = 0; b < searched_at.size(); ++b)
            if (std::isfinite(reach[b]) && reach[b] > 0 &&
                !((body[b].r - searched_at[b]).squaredNorm() < half * half))
                return true;
        return false;
    }

    void search(const std::vector<Motion>& body)
    {
        searched_at.clear();
        for (size_t b = 0; b < reach.size(); ++b) searched_at.push_back(body[b].r);
        searched_margin = std::numeric_limits<double>::quiet_NaN();  // should the search fail
        const auto& candidates = broad_phase.find(searched_at, reach, margin + skin_length());
        searched_margin = margin;

        before.swap(pairs);
        pairs.clear();
        auto old = before.begin();
        const auto lower = [](const Pair& p) { return std::pair(std::min(p.i, p.j), std::max(p.i, p.j)); };
        for (const Candidate& c : candidates) {
            Pair now = pair_of(c);
            if (now.law == nullptr) continue;
            while (old != before.end() && lower(*old) < std::pair(c.i, c.j)) ++old;
            if (old != before.end() && lower(*old) == std::pair(c.i, c.j)) now.state = std::move(old->state);
            pairs.push_back(std::move(now));
        }
    }

    std::vector<BodyType> kinds;
    std::vector<std::vector<std::unique_ptr<const Law>>> laws;
    std::vector<int> kind_of;   // of each body
    std::vector<double> reach;  // of each body, negative for those of no kind
    std::vector<Vec3> searched_at;
    double searched_margin = 0;
    BroadPhase broad_phase;
    std::vector<Pair> pairs, before;
};

}  // namespace hilda::contact
