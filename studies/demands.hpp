// SPDX-License-Identifier: GPL-3.0-or-later
/// --check: what must come out of a study, by number.

#pragma once

#include <nlohmann/json_fwd.hpp>

#include <cmath>
#include <iosfwd>
#include <string>
#include <vector>

namespace hilda::studies {

/// What came out, and what should have: NaN is never met.
struct Demand {
    std::string what;
    double measured = 0, demanded = 0, tolerance = 0;
    std::string by = {};  ///< closed form, published run, ...

    bool met() const { return std::abs(measured - demanded) <= tolerance; }
};

/// That something be from `least` to `most`
Demand between(const std::string& what, double measured, double least, double most);

/// Whether all are met; a table of them, "N of M met" below it, and the same as "checks" for study.json.
bool judge(const std::vector<Demand>& demands, std::ostream& out, nlohmann::ordered_json& json);

}  // namespace hilda::studies
