// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/study.hpp"

#include <algorithm>

namespace hilda::studies {

namespace {

std::vector<Study>& list()
{
    static std::vector<Study> all;
    return all;
}

}  // namespace

const std::vector<Study>& studies() { return list(); }

bool enrol(Study study)
{
    std::vector<Study>& all = list();
    const auto at = std::lower_bound(all.begin(), all.end(), study,
                                     [](const Study& a, const Study& b) { return a.kind < b.kind; });
    all.insert(at, std::move(study));
    return true;
}

}  // namespace hilda::studies
