// SPDX-License-Identifier: GPL-3.0-or-later
/// Columns of a table of rows of any type: each column states its name, its heading and its value once. The
/// table on the terminal, the CSV file and the objects of study.json are made from the same list.

#pragma once

#include "io/json.hpp"
#include "studies/framework/run.hpp"
#include "studies/framework/table.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <stdexcept>

namespace hilda::studies {

template <class Row>
struct Column {
    using Value = std::function<Table::Cell(const Row&)>;  ///< a function or a pointer to a member

    std::string name;     ///< in CSV and JSON; "": only in the text
    std::string heading;  ///< in the text; "": only in CSV and JSON
    std::string format;   ///< fmt format of numbers in the text
    Value value;

    Column(std::string name, Value value) : Column(std::move(name), "", std::move(value)) {}
    Column(std::string name, std::string heading, Value value)
        : Column(std::move(name), std::move(heading), "{:.3e}", std::move(value))
    {}
    Column(std::string name, std::string heading, std::string format, Value value)
        : name(std::move(name)), heading(std::move(heading)), format(std::move(format)),
          value(std::move(value))
    {}
    /// A column of a base class of Row
    template <class Base>
    Column(const Column<Base>& base) : Column(base.name, base.heading, base.format, Value(base.value))
    {}
    /// The same values with another heading and format in the text
    Column as(std::string text_heading, std::string text_format = "{:.3e}") const
    {
        return {name, std::move(text_heading), std::move(text_format), value};
    }
};

/// Pointers to the rows that satisfy the condition
template <class Row, class Condition>
std::vector<const Row*> those(const std::vector<Row>& rows, const Condition& condition)
{
    std::vector<const Row*> some;
    for (const Row& row : rows)
        if (condition(row)) some.push_back(&row);
    return some;
}

template <class Row>
class Columns {
public:
    using Names = std::vector<std::string>;
    using Rows = std::vector<const Row*>;

    Columns(std::initializer_list<Column<Row>> columns) : all(columns) {}
    explicit Columns(std::vector<Column<Row>> columns) : all(std::move(columns)) {}
    Columns operator+(const Columns& more) const
    {
        Columns sum(*this);
        sum.all.insert(sum.all.end(), more.all.begin(), more.all.end());
        return sum;
    }

    /// The text of a CSV file with all columns that have a name
    std::string csv(const std::vector<Row>& rows) const
    {
        return table(pointers<const Row*>(rows), selected({}, &Column<Row>::name), &Column<Row>::name).csv();
    }
    /// Prints the columns with these names, or with these headings if they have no name; without names all
    /// that have a heading.
    void print(StudyText& out, const Rows& rows, const Names& names = {}) const
    {
        table(rows, selected(names, &Column<Row>::heading), &Column<Row>::heading).print(out);
    }
    void print(StudyText& out, const std::vector<Row>& rows, const Names& names = {}) const
    {
        print(out, pointers<const Row*>(rows), names);
    }
    /// Adds the columns with these names to a JSON object; without names all that have a name.
    io::Json json(const Row& row, const Names& names = {}, io::Json object = io::Json::object()) const
    {
        for (const Column<Row>* column : selected(names, &Column<Row>::name))
            object[column->name] =
                std::visit([](const auto& value) { return io::Json(value); }, column->value(row));
        return object;
    }
    /// An array with an object for each row. The objects of runs begin with the keys of as_json(run).
    template <class AnyRows>
    io::Json array(const AnyRows& rows, const Names& names = {}) const
    {
        io::Json list = io::Json::array();
        for (const auto& element : rows) {
            const Row* row = nullptr;
            if constexpr (std::is_pointer_v<std::decay_t<decltype(element)>>)
                row = element;
            else
                row = &element;
            if constexpr (std::is_base_of_v<Run, Row>)
                list.push_back(json(*row, names, as_json(*row)));
            else
                list.push_back(json(*row, names));
        }
        return list;
    }
    /// Numbers of a row in those columns that have one of these names
    std::map<std::string, double> numbers(const Row& row, const Names& names) const
    {
        std::map<std::string, double> values;
        for (const Column<Row>& column : all)
            if (std::find(names.begin(), names.end(), column.name) != names.end())
                values[column.name] = number(column.value(row));
        return values;
    }

private:
    using Text = std::string Column<Row>::*;
    using Selected = std::vector<const Column<Row>*>;

    Selected selected(const Names& names, Text not_empty) const
    {
        Selected some;
        for (const Column<Row>& column : all)
            if (names.empty() && !(column.*not_empty).empty()) some.push_back(&column);
        for (const std::string& name : names) {
            const auto at = std::find_if(all.begin(), all.end(), [&](const Column<Row>& column) {
                return name == (column.name.empty() ? column.heading : column.name);
            });
            if (at == all.end()) throw std::logic_error("no column of the table is called " + name);
            some.push_back(&*at);
        }
        return some;
    }

    Table table(const Rows& rows, const Selected& columns, Text title) const
    {
        std::vector<Table::Column> titles;
        for (const Column<Row>* column : columns) titles.push_back({column->*title, column->format});
        Table out(titles);
        for (const Row* row : rows) {
            std::vector<Table::Cell> cells;
            for (const Column<Row>* column : columns) cells.push_back(column->value(*row));
            out.add(cells);
        }
        return out;
    }

    std::vector<Column<Row>> all;
};

/// Columns that runs have in common; as(heading, format) gives them other headings.
namespace column {

using OfRun = const Column<Run>;
inline OfRun problem("problem", [](const Run& run) { return run.c->problem.name; });
inline OfRun integrator("integrator", "integrator", [](const Run& run) { return run.scheme->name; });
inline OfRun h("h", "h [s]", "{:.1e}", [](const Run& run) { return run.rtol > 0 ? std::nan("") : run.h; });
inline OfRun rtol("rtol", [](const Run& run) { return run.rtol > 0 ? run.rtol : std::nan(""); });
inline OfRun resolution("", "step or rtol", &Run::resolution);
inline OfRun end("end", [](const Run& run) { return run.c->end; });
inline OfRun reference("reference", [](const Run& run) { return run.c->reference_name; });
inline OfRun observable("observable_scalar", [](const Run& run) { return run.c->observable.name(); });
inline OfRun steps("steps", [](const Run& run) { return run.statistics.steps; });
inline OfRun iterations("iterations_per_step", "iter", "{:.2f}",
                        [](const Run& run) { return run.statistics.iterations_per_step(); });
inline OfRun factorizations("factorizations", [](const Run& run) { return run.statistics.factorizations; });
inline OfRun refactorizations("refactorizations",
                              [](const Run& run) { return run.statistics.refactorizations; });
inline OfRun cpu_seconds("cpu_seconds", &Run::seconds);
inline OfRun status("status", "status", &Run::status);

}  // namespace column

}  // namespace hilda::studies
