// SPDX-License-Identifier: GPL-3.0-or-later
/// Acceptance criteria of a study, evaluated by --check.

#pragma once

#include "io/json.hpp"

#include <string>
#include <vector>

namespace hilda::studies {

class StudyText;

/// A measured value and its bounds. The criterion passes if least <= measured <= most; NaN fails.
struct Criterion {
    std::string what;
    double measured = 0, least = 0, most = 0;

    bool passed() const { return measured >= least && measured <= most; }
};

/// Criterion with the bounds least and most
Criterion between(const std::string& what, double measured, double least, double most);
/// Criterion with the bounds value - tolerance and value + tolerance
Criterion criterion(const std::string& what, double measured, double value, double tolerance);

/// Adds criteria of one run to a list; each description ends with `of`.
struct CriteriaOf {
    std::string of;
    std::vector<Criterion>& list;

    void between(const std::string& what, double measured, double least, double most)
    {
        list.push_back(studies::between(what + of, measured, least, most));
    }
    void equals(const std::string& what, double measured, double value, double tolerance)
    {
        list.push_back(criterion(what + of, measured, value, tolerance));
    }
};

/// Evaluates the criteria. Prints a table and the line "N of M passed", and adds the same as "checks" to the
/// contents of study.json. Returns true if all criteria pass.
bool evaluate(const std::vector<Criterion>& criteria, StudyText& out, io::Json& json);

}  // namespace hilda::studies
