// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/bindings/events.hpp"

#include "io/archive.hpp"

#include <pybind11/numpy.h>

#include <algorithm>

namespace hilda::python {

namespace py = pybind11;

namespace {

class Table final : public run::RunTable {
public:
    Table(std::vector<double>& to, size_t columns) : to(to), columns(columns) {}

    void open() override {}
    void row(const std::vector<double>& values) override
    {
        to.insert(to.end(), values.begin(), values.end());
    }
    void sync() override {}
    void transfer(io::Archive& a) override
    {
        a.list(to);
        a.check(to.size() % columns == 0, "incomplete row of an event");
    }
    void close() override {}
    std::vector<std::string> files() const override { return {}; }
    std::string label() const override { return "events"; }

private:
    std::vector<double>& to;
    const size_t columns;
};

}  // namespace

std::unique_ptr<run::RunTable> EventTables::table(const std::string& /*name*/,
                                                  std::vector<run::TableColumn> all)
{
    columns = all.size();
    return std::make_unique<Table>(values, columns);
}

py::dict EventTables::arrays(size_t bodies) const
{
    const auto n = static_cast<py::ssize_t>(values.size() / columns), b = static_cast<py::ssize_t>(bodies);
    py::dict all;
    const auto add = [&](const char* name, std::vector<py::ssize_t> shape, size_t first, size_t each) {
        py::array_t<double> array(std::move(shape));
        double* to = array.mutable_data();
        for (size_t row = 0; row < values.size(); row += columns)
            for (size_t body = 0; body < (first < 3 ? 1 : bodies); ++body)
                to = std::copy_n(values.data() + row + first + 24 * body, each, to);
        all[name] = array;
    };
    // The order of the columns of the table events: t, event, direction, then those of body_columns()
    add("t", {n}, 0, 1);
    add("event", {n}, 1, 1);
    add("direction", {n}, 2, 1);
    add("r", {n, b, 3}, 3, 3);
    add("A", {n, b, 3, 3}, 6, 9);
    add("rdot", {n, b, 3}, 15, 3);
    add("omega_bar", {n, b, 3}, 18, 3);
    add("rddot", {n, b, 3}, 21, 3);
    add("omegadot_bar", {n, b, 3}, 24, 3);
    return all;
}

}  // namespace hilda::python
