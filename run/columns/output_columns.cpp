// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/columns/output_columns.hpp"

#include "dae/model.hpp"
#include "io/error.hpp"
#include "io/expression.hpp"
#include "io/nearest.hpp"
#include "lie/check.hpp"

#include <algorithm>
#include <cctype>
#include <optional>
#include <unordered_set>

namespace hilda::run {

struct OutputColumns::Part {
    const dae::Output* output;
    size_t count;  ///< of the columns
    std::optional<io::Expression> expression;
};

namespace {

/// Kinetic plus potential energy, as in trajectory.csv
class EnergyColumn final : public ColumnGroup {
public:
    explicit EnergyColumn(const dae::Model& model)
        : ColumnGroup({{"energy", "J",
                        "kinetic energy plus potential energy of gravity, springs and contact springs"}}),
          model(model)
    {}
    void values(const lie::State& x, double* out) override { *out = lie::energy(model, x); }

private:
    const dae::Model& model;
};

std::unique_ptr<ColumnGroup> energy_column(const dae::Model& model)
{
    return std::make_unique<EnergyColumn>(model);
}

/// Largest scaled residual of the position constraints, as in trajectory.csv
class ConstraintNormColumn final : public ColumnGroup {
public:
    explicit ConstraintNormColumn(const dae::Model& model)
        : ColumnGroup(
              {{"constraint_norm", "m or rad", "largest scaled residual of the position constraints"}}),
          model(model)
    {}
    void values(const lie::State& x, double* out) override { *out = model.largest_residual(x).value; }

private:
    const dae::Model& model;
};

std::unique_ptr<ColumnGroup> constraint_norm_column(const dae::Model& model)
{
    return std::make_unique<ConstraintNormColumn>(model);
}

std::vector<const dae::Output*> pointers(const std::vector<std::unique_ptr<dae::Output>>& outputs)
{
    std::vector<const dae::Output*> all;
    for (const auto& output : outputs) all.push_back(output.get());
    return all;
}

std::vector<dae::Quantity> columns_of(const std::vector<const dae::Output*>& outputs)
{
    std::vector<dae::Quantity> all;
    for (const dae::Output* output : outputs)
        for (const dae::Quantity& q : output->quantities())
            all.push_back({q.name.empty() ? output->name : output->name + '.' + q.name, q.unit, q.meaning});
    return all;
}

/// Hint for a formula that contains the name of a column that must be in braces
std::string hint_of_braces(const std::string& text, const std::vector<std::string>& names)
{
    const auto is_plain = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '.'; };
    for (const std::string& name : names)
        if (!std::all_of(name.begin(), name.end(), is_plain) && text.find(name) != std::string::npos &&
            text.find('{' + name + '}') == std::string::npos)
            return "; write {" + name + "} in braces";
    return "";
}

}  // namespace

OutputColumns::OutputColumns(const dae::Model& model,
                             const std::vector<std::unique_ptr<dae::Output>>& outputs)
    : OutputColumns(model, pointers(outputs))
{}

OutputColumns::OutputColumns(const dae::Model& model, const std::vector<const dae::Output*>& outputs)
    : ColumnGroup(columns_of(outputs))
{
    variable.resize(1), first_output = 1;
    if (outputs.empty()) return;  // the names of all columns take much longer than the model
    std::vector<std::string> names = {"t"};
    for (auto make : {body_columns, energy_column, force_columns, contact_columns}) {
        sources.push_back({.group = make(model), .first = names.size()});
        for (const dae::Quantity& c : sources.back().group->columns) names.push_back(c.name);
    }
    first_output = names.size();
    std::unordered_set<std::string> known(names.begin(), names.end());
    for (const dae::Output* output : outputs) {
        Part part{.output = output, .count = output->quantities().size(), .expression = {}};
        if (const std::string text = output->expression(); !text.empty()) try {
                part.expression.emplace(text, names);
            } catch (const io::ExpressionError& e) {
                throw lie::InvalidInput(output->place + ": " + e.what() + hint_of_braces(text, names));
            }
        for (Source& source : sources)
            for (size_t k = 0; part.expression && k < source.group->columns.size(); ++k)
                source.is_used = source.is_used || part.expression->uses(source.first + k);
        for (size_t k = 0; k < part.count; ++k) {
            const std::string& name = columns[names.size() - first_output].name;
            if (!known.insert(name).second)
                throw lie::InvalidInput(output->name_place + ": the column '" + name +
                                        "' exists already; give this one another name");
            names.push_back(name);
        }
        parts.push_back(std::move(part));
    }
    variable.resize(names.size());
}

OutputColumns::~OutputColumns() = default;

/// Computes the variables of the expressions, and the first outputs.
void OutputColumns::evaluate(const lie::State& x, size_t count)
{
    variable[0] = x.t;
    for (const Source& source : sources)
        if (source.is_used) source.group->values(x, variable.data() + source.first);
    double* at = variable.data() + first_output;
    for (size_t k = 0; k < count; ++k) {
        const Part& part = parts[k];
        if (part.expression)
            *at = part.expression->value({variable.data(), static_cast<size_t>(at - variable.data())});
        else
            part.output->values(x, at);
        at += part.count;
    }
}

double OutputColumns::expression(const lie::State& x, size_t k, size_t count)
{
    evaluate(x, count);
    return parts[k].expression->value(variable);
}

void OutputColumns::values(const lie::State& x, double* out)
{
    evaluate(x, parts.size());
    std::copy(variable.begin() + static_cast<std::ptrdiff_t>(first_output), variable.end(), out);
}

ObservedColumns::ObservedColumns(const dae::Model& model,
                                 const std::vector<std::unique_ptr<dae::Output>>& outputs,
                                 const std::string& option, const std::vector<std::string>& names)
{
    std::vector<std::unique_ptr<ColumnGroup>> all;
    for (auto make : {body_columns, energy_column, constraint_norm_column, force_columns, contact_columns})
        all.push_back(make(model));
    all.push_back(std::make_unique<OutputColumns>(model, outputs));
    std::vector<std::string> known;
    std::vector<Place> known_places;  // in `all`
    for (size_t g = 0; g < all.size(); ++g)
        for (size_t k = 0; k < all[g]->columns.size(); ++k) {
            known.push_back(all[g]->columns[k].name);
            known_places.push_back({g, k});
        }
    std::vector<size_t> number(all.size(), all.size());  // of each group in `groups`
    for (const std::string& name : names) {
        const auto found = std::find(known.begin(), known.end(), name);
        if (found == known.end())
            throw io::UsageError(option + ": the model has no column" + io::with_nearest(name, known) +
                                 " (hilda help outputs lists the columns)");
        const Place place = known_places[static_cast<size_t>(found - known.begin())];
        if (number[place.group] == all.size()) {
            number[place.group] = groups.size();
            numbers.emplace_back(all[place.group]->columns.size());
            groups.push_back(std::move(all[place.group]));
        }
        places.push_back({number[place.group], place.index});
    }
}

void ObservedColumns::values(const lie::State& x, double* out)
{
    for (size_t g = 0; g < groups.size(); ++g) groups[g]->values(x, numbers[g].data());
    for (const Place& place : places) *out++ = numbers[place.group][place.index];
}

}  // namespace hilda::run
