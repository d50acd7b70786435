// SPDX-License-Identifier: GPL-3.0-or-later
/// The columns of the outputs that a model file lists.

#pragma once

#include "dae/outputs/output.hpp"
#include "studies/running/state_columns.hpp"

namespace hilda::studies {

/// The columns of all outputs, with the names NAME.quantity, or NAME for an expression.
///
/// The variables of an expression are t, the columns of body_columns(), force_columns() and
/// contact_columns(), and those of the preceding outputs. Only the groups that an expression uses are
/// computed.
class OutputColumns final : public ColumnGroup {
public:
    /// The model and the outputs must outlive this object. lie::InvalidInput with the place of an expression
    /// that is invalid or names an unknown column.
    OutputColumns(const dae::Model& model, const std::vector<std::unique_ptr<dae::Output>>& outputs);
    OutputColumns(const dae::Model& model, const std::vector<const dae::Output*>& outputs);
    ~OutputColumns() override;

    void node(const lie::State& x) override;
    void values(const lie::State& x, double* out) override;
    void transfer(io::Archive& a) override;

private:
    struct Part;  ///< an output with its saved numbers or its compiled expression

    /// A group of columns that are variables of expressions
    struct Source {
        std::unique_ptr<ColumnGroup> group;
        size_t first;  ///< index of its first variable
        bool is_used = false;
    };

    std::vector<Source> sources;
    std::vector<Part> parts;
    std::vector<double> variable;  ///< t, the columns of the sources, those of the outputs
    size_t first_output = 0;       ///< index of the first variable of the outputs
};

/// One column of a run by its name: of bodies, energy, forces, contacts or outputs
class ObservedColumn {
public:
    /// The model and the outputs must outlive this object. io::UsageError with `option` for an unknown name.
    ObservedColumn(const dae::Model& model, const std::vector<std::unique_ptr<dae::Output>>& outputs,
                   const std::string& option, const std::string& name);

    /// The value in the state x. To be called at each node of a run, in order.
    double at(const lie::State& x);
    const dae::Quantity& column() const { return group->columns[index]; }

private:
    std::unique_ptr<ColumnGroup> group;
    size_t index = 0;
    std::vector<double> value;
};

}  // namespace hilda::studies
