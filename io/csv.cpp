// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/csv.hpp"

#include "io/error.hpp"

#include <algorithm>

namespace hilda::io {

namespace {

std::string_view trimmed(std::string_view s)
{
    const auto first = s.find_first_not_of(" \t\r"), last = s.find_last_not_of(" \t\r");
    return first == std::string_view::npos ? std::string_view{} : s.substr(first, last - first + 1);
}

std::vector<std::string_view> cells_of(std::string_view line)
{
    std::vector<std::string_view> all;
    for (std::size_t from = 0; from <= line.size();) {
        const std::size_t to = std::min(line.find(',', from), line.size());
        all.push_back(trimmed(line.substr(from, to - from)));
        from = to + 1;
    }
    return all;
}

}  // namespace

void read_csv(std::string_view text, const std::string& file, const std::function<void(const CsvRow&)>& use)
{
    std::vector<std::string_view> names;
    long line = 0;
    for (std::size_t from = 0; from < text.size();) {
        const std::size_t to = std::min(text.find('\n', from), text.size());
        const std::string_view here = trimmed(text.substr(from, to - from));
        from = to + 1, ++line;
        if (here.empty() || here.starts_with('#')) continue;
        CsvRow row{names, cells_of(here), file + ':' + std::to_string(line)};
        if (names.empty()) {
            names = row.cells;
            for (auto name = names.begin(); name != names.end(); ++name)
                if (std::find(names.begin(), name, *name) != name)
                    throw InvalidInput(row.place + ": two columns have the same name, got '" +
                                       std::string(*name) + '\'');
            continue;
        }
        if (row.cells.size() != names.size())
            throw InvalidInput(row.place + ": a row must have a field for each of the " +
                               std::to_string(names.size()) + " columns, got " +
                               std::to_string(row.cells.size()));
        use(row);
    }
}

}  // namespace hilda::io
