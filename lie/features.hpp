// SPDX-License-Identifier: GPL-3.0-or-later
/// What a system may have besides holonomic constraints, and what a scheme must support to integrate it.

#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace hilda::lie {

class System;

/// A part of the equations that not every scheme supports. A new one is a line here and in all_features(), a
/// condition in features_of(), and a word in Scheme::supports of the schemes that support it.
enum class Feature : unsigned {
    algebraic,     ///< algebraic variables α of position rows: evolving contacts
    regularised,   ///< regularised rows with a bound (BoundedPair): implicit friction
    nonholonomic,  ///< nonholonomic rows: rolling without slip
    redundant,     ///< rows that may be dependent, see System::keeps_redundant_rows()
    cones,         ///< rigid contacts with Coulomb friction, see System::cones()
    history,       ///< loads that depend on a history, see System::internal_states_are_history()
    springs        ///< implicit evaluation of System::spring_pattern(), see ImplicitSprings
};

/// A set of features
class Features {
public:
    constexpr Features() = default;
    constexpr Features(std::initializer_list<Feature> features)
    {
        for (const Feature f : features) add(f);
    }

    constexpr bool contains(Feature f) const { return (bits & bit(f)) != 0; }
    constexpr bool contains(Features all) const { return (all.bits & ~bits) == 0; }
    constexpr void add(Feature f) { bits |= bit(f); }
    /// The features of this set that `other` does not contain
    constexpr Features without(Features other) const
    {
        other.bits = bits & ~other.bits;
        return other;
    }

private:
    static constexpr unsigned bit(Feature f) { return 1u << static_cast<unsigned>(f); }

    unsigned bits = 0;
};

/// The words for a feature
struct FeatureText {
    Feature feature;
    std::string_view key;   ///< in lists of schemes
    std::string_view text;  ///< in messages: "does not support TEXT"
};

/// All features, in the order in which lists and messages name them
const std::vector<FeatureText>& all_features();

/// The keys of a set, in the order of all_features()
std::vector<std::string> keys_of(Features features);

/// The features that a scheme must support to integrate the system. Springs are not among them: a scheme that
/// does not support them evaluates them as other loads. Neither is a history, which depends on the state: a
/// scheme that does not support it refuses it in its first step.
Features features_of(const System& system);

}  // namespace hilda::lie
