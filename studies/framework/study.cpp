// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/study.hpp"

#include <algorithm>
#include <utility>

namespace hilda::studies {

namespace {

std::vector<Study>& list()
{
    static std::vector<Study> all;
    return all;
}

using Maker = std::vector<Study> (*)();

std::vector<Maker>& makers()
{
    static std::vector<Maker> all;
    return all;
}

}  // namespace

const std::vector<Study>& studies()
{
    for (const Maker make : std::exchange(makers(), {}))
        for (Study& study : make()) register_study(std::move(study));
    return list();
}

bool register_studies(Maker make)
{
    makers().push_back(make);
    return true;
}

bool register_study(Study study)
{
    std::vector<Study>& all = list();
    const auto at = std::lower_bound(all.begin(), all.end(), study,
                                     [](const Study& a, const Study& b) { return a.kind < b.kind; });
    all.insert(at, std::move(study));
    return true;
}

}  // namespace hilda::studies
