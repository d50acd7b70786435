// SPDX-License-Identifier: GPL-3.0-or-later
/// The columns of the outputs that a model file lists.

#pragma once

#include "dae/outputs/output.hpp"
#include "run/columns/state_columns.hpp"

namespace hilda::run {

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

    void values(const lie::State& x, double* out) override;
    /// The value of expression k of the list, which uses the first `count` outputs of the list only
    double expression(const lie::State& x, size_t k, size_t count);

private:
    void evaluate(const lie::State& x, size_t count);
    struct Part;  ///< an output with its compiled expression

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

/// Columns of a run by their names: of bodies, energy, forces, contacts or outputs
class ObservedColumns {
public:
    /// The model and the outputs must outlive this object. io::UsageError with `option` for an unknown name.
    ObservedColumns(const dae::Model& model, const std::vector<std::unique_ptr<dae::Output>>& outputs,
                    const std::string& option, const std::vector<std::string>& names);

    /// Their values in the state x
    void values(const lie::State& x, double* out);
    const dae::Quantity& column(size_t k) const { return groups[places[k].group]->columns[places[k].index]; }

private:
    struct Place {
        size_t group, index;
    };
    std::vector<std::unique_ptr<ColumnGroup>> groups;  ///< those with an observed column
    std::vector<std::vector<double>> numbers;          ///< of each group
    std::vector<Place> places;                         ///< of the observed columns
};

/// One of them
class ObservedColumn {
public:
    /// As for ObservedColumns
    ObservedColumn(const dae::Model& model, const std::vector<std::unique_ptr<dae::Output>>& outputs,
                   const std::string& option, const std::string& name)
        : columns(model, outputs, option, {name})
    {}

    /// The value in the state x
    double at(const lie::State& x)
    {
        double value = 0;
        columns.values(x, &value);
        return value;
    }
    const dae::Quantity& column() const { return columns.column(0); }

private:
    ObservedColumns columns;
};

}  // namespace hilda::run
