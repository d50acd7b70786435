// SPDX-License-Identifier: GPL-3.0-or-later
/// --check of a sweep: what must come out of it, by number.

#pragma once

#include <nlohmann/json_fwd.hpp>

#include <iosfwd>
#include <string>
#include <vector>

namespace hilda::studies {

/// What came out, and between which bounds it must be; NaN is between none.
struct Criterion {
    std::string what;
    double measured = 0, least = 0, most = 0;

    bool passed() const { return measured >= least && measured <= most; }
};

Criterion between(const std::string& what, double measured, double least, double most);
/// value +- tolerance
Criterion criterion(const std::string& what, double measured, double value, double tolerance);

/// Whether all are met; a table of them, "N of M met" below it, and the same as "checks" for study.json.
bool evaluate(const std::vector<Criterion>& criteria, std::ostream& out, nlohmann::ordered_json& json);

}  // namespace hilda::studies
