// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/expectations.hpp"

#include "io/error.hpp"
#include "io/message.hpp"
#include "studies/program/arguments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hilda::studies {

void check_keys(const std::string& kind, const StudyOptions& options, std::span<const std::string> known)
{
    for (const Expectation& e : options.expect) {
        if (std::find(known.begin(), known.end(), e.key) != known.end()) continue;
        std::string all;
        for (const std::string& key : known) all += (all.empty() ? "" : ", ") + key;
        throw io::UsageError("study " + kind + ": --expect: unknown key" + with_nearest(e.key, known) +
                             "; known keys: " + all);
    }
}

bool as_expected(const std::vector<Expectation>& expectations, const std::vector<Measured>& measured)
{
    bool passed = true;
    for (const Expectation& e : expectations) {
        bool seen = false;
        for (const Measured& m : measured) {
            const auto found = m.value.find(e.key);
            if (found == m.value.end()) continue;
            seen = true;
            if (std::abs(found->second - e.value) <= e.tolerance) continue;
            passed = false;
            io::message(
                fmt::format("hilda: error: expected {}, got {:.6g} for {}\n", e.text, found->second, m.of));
        }
        if (seen) continue;
        passed = false;
        io::message(
            fmt::format("hilda: error: expected {}, but no run has a value of '{}'\n", e.text, e.key));
    }
    return passed;
}

}  // namespace hilda::studies
