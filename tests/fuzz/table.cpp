// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/error.hpp"
#include "io/formats/csv.hpp"
#include "tests/fuzz/targets.hpp"

#include <cstdlib>

namespace hilda::fuzz {

void table(std::string_view input)
{
    try {
        io::read_csv(input, "table.csv", [](const io::CsvRow& row) {
            if (row.cells.size() != row.names.size()) std::abort();
            for (const std::string_view cell : row.cells)
                if (cell.starts_with(' ') || cell.ends_with(' ')) std::abort();
        });
    } catch (const io::InvalidInput&) {
    }
}

}  // namespace hilda::fuzz
