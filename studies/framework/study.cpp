// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/framework/study.hpp"

#include <algorithm>
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

OptionNames options_of_integrators(const OptionNames& more)
{
    OptionNames all = {"--integrator", "--steps", "--end"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
}

OptionNames options_of_models(const OptionNames& more)
{
    OptionNames all = options_of_integrators(more);
    all.emplace_back("--problem");
    return all;
}

bool Study::lists(const std::string& option) const
{
    return std::find(options.begin(), options.end(), option) != options.end();
}

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
