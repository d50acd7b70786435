// SPDX-License-Identifier: GPL-3.0-or-later
/// Quantities that a model file lists under "outputs".

#pragma once

#include "dae/model_types.hpp"
#include "dae/outputs/quantity.hpp"

#include <memory>
#include <string>
#include <vector>

namespace hilda::dae {

class TurnCounter;

/// One or more scalar quantities of the state, such as the motion of a point. Derive from Output to add a
/// type.
///
/// An output is constant during a run. Everything that changes is in the state.
class Output {
public:
    virtual ~Output() = default;

    /// The quantities that values() computes. A quantity without a name has the name of the output alone.
    virtual std::vector<Quantity> quantities() const = 0;
    /// The quantities in the state x: quantities().size() numbers. The function must not allocate memory.
    virtual void values(const State& x, double* out) const = 0;

    /// The angle whose turns the state counts for this output, for Model::count(); nullptr: none
    virtual std::shared_ptr<TurnCounter> turns() const { return {}; }

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
