// SPDX-License-Identifier: GPL-3.0-or-later
/// Parameters of a model file: named numbers, used in expressions.
///
///     "parameters": {"l": 2, "m": "3*l"},  "bodies": [{"mass": "m/2", "r": [0, "l*cos(pi/6)", 0], ...}]

#pragma once

#include "io/expression.hpp"
#include "io/json_source.hpp"

namespace hilda::dae {

class Parameters final : public io::Parameters {
public:
    static constexpr std::size_t most = 1000;  ///< largest number of parameters of a model

    /// Evaluates the key "parameters" of the root object of `source`, which may be missing. The parameters
    /// may refer to each other in any order. Throws io::PlacedError for an invalid name, for an invalid
    /// expression, for a value that is not finite, and for parameters that depend on each other in a cycle.
    explicit Parameters(const io::JsonSource& source);

    double value(const std::string& expression) const override;
    std::string substituted(const std::string& expression,
                            const std::vector<std::string>& variables) const override;
    std::string replaced(const std::string& expression,
                         const std::vector<std::string>& variables) const override;

    /// Names and values in the order of the file
    const io::Expression::Constants& all() const { return parameters; }

    /// Throws io::PlacedError for a parameter that a --set added and that nothing uses. To be called when the
    /// model has been read.
    void check_added() const;
    /// Warnings, with their locations, about parameters that nothing uses, and about parameters with the name
    /// of a variable of an expression that contains the name. To be called when the model has been read.
    std::vector<std::string> warnings() const;

private:
    void evaluate(std::size_t k, std::vector<std::size_t>& path);
    void check_known(const std::string& expression, const std::vector<std::string>& variables) const;
    void mark_used(const std::string& expression) const;
    std::string pointer(std::size_t k) const;

    const io::JsonSource& source;
    std::vector<const io::Json::Member*> given;
    std::vector<std::string> names;
    io::Expression::Constants parameters;      ///< names and values
    std::vector<bool> known;                   ///< whether the value has been computed
    mutable std::vector<bool> used, shadowed;  ///< by an expression; by a variable of the same name
};

}  // namespace hilda::dae
