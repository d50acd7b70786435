// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/law_names.hpp"

#include "granular/case/pair_keys.hpp"

namespace hilda::granular {

std::vector<std::string> law_names(const std::string& kind)
{
    std::vector<std::string> names;
    for_each_kind([&]<class Laws>(const char* of, const char*, Laws PairLaw::*) {
        if (of != kind) return;
        Laws::for_each([&](const auto& law) { names.emplace_back(law.name); });
    });
    return names;
}

}  // namespace hilda::granular
