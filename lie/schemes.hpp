// SPDX-License-Identifier: GPL-3.0-or-later
/// The list of time-stepping schemes.

#pragma once

#include "io/option_values.hpp"
#include "io/registry.hpp"
#include "lie/features.hpp"
#include "lie/loads.hpp"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace hilda::lie {

class Integrator;
struct Settings;
class System;

/// An option that a scheme declares: a number, or a switch with the values 0 and 1. The constructor of the
/// scheme copies the value from Settings::of_scheme.
struct SchemeOption {
    io::Option option;
    double default_value = 0;
};

/// The options of a scheme with Newton's method on the saddle-point system
inline const std::vector<std::string> newton_options = {"--tolerance", "--max-iterations", "--linear-solver"};

/// A scheme of the list: its name, its properties and its constructor.
struct Scheme {
    std::string name;
    std::string description = {};  ///< one line: the textbook name, and what distinguishes the scheme
    int order = 1;                 ///< of r, A, ṙ, ω̄ for smooth motions
    int order_lambda = 1;          ///< of the multipliers, for a start in motion
    std::string formulation;       ///< rA, rp, reps or tree
    std::string unknowns;          ///< of the Newton iteration
    /// Names of the options of Settings that the scheme uses, as in run::setting_options(): --tolerance. An
    /// option that none of the integrators of a command uses is refused.
    std::vector<std::string> uses = {};      ///< newton_options, or others
    std::vector<SchemeOption> options = {};  ///< of this scheme only; schemes may share one
    std::string source;                      ///< reference
    bool adaptive = false;                   ///< whether the scheme chooses internal steps from rtol and atol
    /// Whether State contains all that a continued run needs. Otherwise a run cannot be resumed.
    bool resumes = true;
    /// For a scheme of fixed step that can also choose its steps: the same scheme with internal steps. It is
    /// not in the list.
    std::shared_ptr<const Scheme> adaptive_form = nullptr;
    LoadEvaluation loads = LoadEvaluation::at_step;
    /// Largest h ω for which an undamped oscillator does not gain energy, at most 2. The stability limits of
    /// forces are those of 2.
    double stability = 2;
    /// Whether the scheme takes only systems whose joints form a tree, see System::tree()
    bool needs_tree = false;
    Features supports = {};  ///< what the scheme integrates besides holonomic constraints
    /// Whether the energy of a conservative system may drift in one direction, by an error of the order of
    /// the scheme. Other schemes of fixed step conserve or dissipate it.
    bool energy_drifts = false;
    std::unique_ptr<Integrator> (*construct)(const System&, const Settings&) = nullptr;

    /// The scheme that chooses its steps, if there is one; otherwise this scheme
    const Scheme& with_adaptive_steps() const { return adaptive_form ? *adaptive_form : *this; }
    /// Names of the options that the scheme uses and declares
    std::vector<std::string> option_names() const;
    bool uses_option(const std::string& option) const;

    /// Whether make() accepts the system
    bool takes(const System& system) const;
    /// Constructs the integrator. Throws InvalidInput if the system has a feature that the scheme does not
    /// take, and for a value of Settings::of_scheme that is not finite.
    std::unique_ptr<Integrator> make(const System& system, const Settings& settings) const;
};

}  // namespace hilda::lie

extern template class hilda::io::Registry<hilda::lie::Scheme>;

namespace hilda::lie {

/// All schemes, sorted by name
inline const std::vector<Scheme>& schemes() { return io::Registry<Scheme>::all(); }

/// The scheme with this name. Throws InvalidInput with the list of names if there is none.
const Scheme& scheme(const std::string& name);

/// Adds a scheme. Throws std::logic_error if there is one with this name, if the name of one of its options
/// does not begin with two dashes, or if another scheme declares an option with this name in another way.
bool add_scheme(Scheme scheme);

/// Adds the scheme of the class Method, which has the constructor Method(const System&, const Settings&). The
/// file of a scheme ends with this call.
template <class Method>
bool register_scheme(Scheme scheme)
{
    scheme.construct = [](const System& system, const Settings& settings) -> std::unique_ptr<Integrator> {
        return std::make_unique<Method>(system, settings);
    };
    return add_scheme(std::move(scheme));
}

}  // namespace hilda::lie
