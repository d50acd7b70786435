// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/validations/validation.hpp"

#include <algorithm>
#include <utility>

namespace hilda::granular {

namespace {

std::vector<Validation>& list()
{
    static std::vector<Validation> all;
    return all;
}

}  // namespace

const std::vector<Validation>& validations() { return list(); }

bool register_validation(Validation v)
{
    const auto before = [](const Validation& a, const Validation& b) { return a.name < b.name; };
    const auto at = std::upper_bound(list().begin(), list().end(), v, before);
    list().insert(at, std::move(v));
    return true;
}

}  // namespace hilda::granular
