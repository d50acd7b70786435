// SPDX-License-Identifier: GPL-3.0-or-later
/// Command lines that the program refuses.

#pragma once

#include "tests/support/program/program.hpp"

#include <catch2/catch.hpp>

#include <set>

namespace hilda::tests {

/// Paths of all files and directories below a scratch directory, without those of the tests and without the
/// default directory "out" of results, which a study may have created
inline std::set<std::string> entries(const Scratch& in)
{
    std::set<std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(in.path))
        if (!entry.path().filename().string().starts_with('.') && entry.path() != in / "out")
            all.insert(entry.path().string());
    return all;
}

/// Requires that the program ends with this exit code and an error message of one line that contains
/// `message`, prints no results and writes no files.
inline void check_refused(const Scratch& in, const std::vector<std::string>& arguments, int code,
                          const std::string& message)
{
    const std::set<std::string> before = entries(in);
    const Ended ended = call(in, arguments);
    CAPTURE(arguments, ended.err);
    CHECK(ended.code == code);
    CHECK_THAT(ended.err,
               Catch::Matchers::StartsWith("hilda: error: ") && Catch::Matchers::Contains(message));
    CHECK(ended.err.find('\n') == ended.err.size() - 1);
    CHECK(ended.out.empty());
    CHECK(entries(in) == before);
}

}  // namespace hilda::tests
