// SPDX-License-Identifier: GPL-3.0-or-later
/// The entries of `fill` of a case.

#pragma once

#include "granular/case/case_file.hpp"
#include "granular/case/entry_keys.hpp"
#include "granular/case/particles/fill.hpp"

namespace hilda::granular {

class FillList {
public:
    /// Reads an entry. Throws io::InvalidInput.
    void read(ObjectReader& o, Case& c, EntryKeys& keys, const WorldOptions& options);
    /// Generates the particles of all entries and adds them to the world of the case. Throws
    /// io::InvalidInput; a message about a particle of a table has its line.
    void add_to(Case& c, EntryKeys& keys);

    const std::vector<FillSpec>& specs() const { return fills; }

private:
    std::vector<FillSpec> fills;
    std::vector<ObjectReader> places;
    std::vector<int> groups;
};

}  // namespace hilda::granular
