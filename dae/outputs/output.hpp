// SPDX-License-Identifier: GPL-3.0-or-later
/// Quantities that a model file lists under "outputs".

#pragma once

#include "dae/model_types.hpp"
#include "dae/outputs/quantity.hpp"

#include <memory>
#include <string>
#include <vector>

namespace hilda::dae {

/// One or more scalar quantities of the state, such as the motion of a point. Derive from Output to add a
/// type.
///
/// An output is constant during a run. What it has to remember from node to node, such as the revolutions of
/// an angle, is an array of numbers that the caller keeps.
class Output {
public:
    virtual ~Output() = default;

    /// The quantities that values() computes. A quantity without a name has the name of the output alone.
    virtual std::vector<Quantity> quantities() const = 0;
    /// The quantities in the state x: quantities().size() numbers. The function must not allocate memory.
    virtual void values(const State& x, const double* saved, double* out) const = 0;

    /// Number of the saved numbers. They are zero before the first node.
    virtual int saved_numbers() const { return 0; }
    /// Updates the saved numbers. Called once at each node, in order, before values().
    virtual void update(const State& /*x*/, double* /*saved*/) const {}

    /// The text of an expression in the columns of the run, which the output is; empty for other types.
    /// values() is not called for an expression.
    virtual std::string expression() const { return {}; }

    std::string name;
    std::string place,
        name_place;  ///< locations of its content and of its name in the model file, for messages
};

/// A type of output
struct OutputType {
    std::string name;  ///< value of the key "type"
    TypeSchema schema;
    /// Reads the keys of the type, including those of the bodies. `columns`: columns with names that a
    /// parameter may have. Throws as ConstraintType::read.
    std::unique_ptr<Output> (*read)(ObjectReader& o, const BodyFinder& bodies, const State& x,
                                    const std::vector<std::string>& columns);
};

}  // namespace hilda::dae

extern template class hilda::io::Registry<hilda::dae::OutputType>;
