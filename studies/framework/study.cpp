// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/study.hpp"

#include <utility>

namespace hilda::studies {

namespace {

using Maker = std::vector<Study> (*)();

std::vector<Maker>& makers()
{
    static std::vector<Maker> all;
    return all;
}

}  // namespace

const std::vector<Study>& studies()
{
    while (!makers().empty())  // a maker may load a module that registers others
        for (const Maker make : std::exchange(makers(), {}))
            for (Study& study : make()) io::Registry<Study>::add(std::move(study));
    return io::Registry<Study>::all();
}

bool register_studies(Maker make)
{
    makers().push_back(make);
    return true;
}

}  // namespace hilda::studies

template class hilda::io::Registry<hilda::studies::Study>;
