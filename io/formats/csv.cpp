// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/formats/csv.hpp"

#include "io/error.hpp"
#include "io/files.hpp"
#include "io/message.hpp"

#include <algorithm>
#include <deque>

namespace hilda::io {

namespace {

std::string_view trimmed(std::string_view s)
{
    const auto first = s.find_first_not_of(" \t\r"), last = s.find_last_not_of(" \t\r");
    return first == std::string_view::npos ? std::string_view{} : s.substr(first, last - first + 1);
}

/// The content of a cell in quotes, as csv_field() writes it. `store` keeps the text of a content with
/// quotes.
std::string_view unquoted(std::string_view cell, std::deque<std::string>& store)
{
    if (cell.size() < 2 || !cell.starts_with('"') || !cell.ends_with('"')) return cell;
    cell = cell.substr(1, cell.size() - 2);
    if (cell.find('"') == std::string_view::npos) return cell;
    std::string& text = store.emplace_back();
    for (std::size_t k = 0; k < cell.size(); ++k) {
        text += cell[k];
        if (cell[k] == '"' && k + 1 < cell.size() && cell[k + 1] == '"') ++k;
    }
    return text;
}

/// The cells between the commas that are outside of quotes. A quote within a cell that begins otherwise is a
/// character.
std::vector<std::string_view> cells_of(std::string_view line, std::deque<std::string>& store)
{
    std::vector<std::string_view> all;
    bool quoted = false;
    std::size_t from = 0;
    for (std::size_t k = 0; k <= line.size(); ++k) {
        if (k < line.size() && line[k] == '"') {
            if (quoted && k + 1 < line.size() && line[k + 1] == '"')
                ++k;  // a quote of the content
            else if (quoted || trimmed(line.substr(from, k - from)).empty())
                quoted = !quoted;
        }
        if (k < line.size() && (line[k] != ',' || quoted)) continue;
        all.push_back(unquoted(trimmed(line.substr(from, k - from)), store));
        from = k + 1;
    }
    return all;
}

}  // namespace

namespace {

/// Refuses a text in UTF-16, as some spreadsheets write.
void refuse_other_encoding(std::string_view text, const std::string& file)
{
    if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF") ||
        text.substr(0, 4).find('\0') != text.npos)
        throw InvalidInput(file + ": is a text in UTF-16 or binary data; a table is a text in UTF-8");
}

/// Refuses a line of names that is one column because other characters than commas separate them.
void refuse_other_separator(const std::vector<std::string_view>& names, const std::string& place)
{
    if (names.size() != 1) return;
    const std::string_view name = names[0];
    const char* const separator = name.find(';') != name.npos    ? "semicolons"
                                  : name.find('\t') != name.npos ? "tabs"
                                                                 : nullptr;
    if (separator != nullptr)
        throw InvalidInput(place + ": the names of the columns are separated by " + separator +
                           "; a table has commas, and points in its numbers");
}

}  // namespace

void read_csv(std::string_view text, const std::string& file, const std::function<void(const CsvRow&)>& use)
{
    std::vector<std::string_view> names;
    std::deque<std::string> of_names, of_row;  // the references to their texts stay valid
    long line = 0;
    refuse_other_encoding(text, file);
    text = without_byte_order_mark(text);
    for (std::size_t from = 0; from < text.size();) {
        const std::size_t to = std::min(text.find('\n', from), text.size());
        const std::string_view here = trimmed(text.substr(from, to - from));
        from = to + 1, ++line;
        if (here.empty() || here.starts_with('#')) continue;
        of_row.clear();
        CsvRow row{names, cells_of(here, names.empty() ? of_names : of_row),
                   file + ':' + std::to_string(line)};
        if (names.empty()) {
            names = row.cells;
            refuse_other_separator(names, row.place);
            for (auto name = names.begin(); name != names.end(); ++name)
                if (std::find(names.begin(), name, *name) != name)
                    throw InvalidInput(row.place + ": two columns have the same name, got '" +
                                       std::string(*name) + '\'');
            continue;
        }
        if (row.cells.size() != names.size())
            throw InvalidInput(row.place + ": a row must have a field for each of the " +
                               counted(static_cast<long>(names.size()), "column") + ", got " +
                               std::to_string(row.cells.size()));
        use(row);
    }
}

}  // namespace hilda::io
