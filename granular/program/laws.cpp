// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/program/laws.hpp"

#include "granular/case/pair_keys.hpp"
#include "io/message.hpp"
#include "io/option_values.hpp"

namespace hilda::granular {

std::string list_of_laws()
{
    std::string text;
    for_each_kind([&]<class Laws>(const char* kind, const char* standard, Laws PairLaw::*) {
        Laws::for_each([&](const auto& law) {
            text += io::formatted("%-11s %-20s  %s%s\n", kind, law.name, law.description,
                                  std::string(law.name) == standard ? " The default." : "");
        });
    });
    text.pop_back();
    return io::wrapped_help(text);
}

io::Json laws_as_json()
{
    io::Json all = io::Json::array();
    for_each_kind([&]<class Laws>(const char* kind, const char* standard, Laws PairLaw::*) {
        Laws::for_each([&](const auto& law) {
            all.push_back({{"kind", kind},
                           {"name", law.name},
                           {"description", law.description},
                           {"is_default", std::string(law.name) == standard}});
        });
    });
    return all;
}

}  // namespace hilda::granular
