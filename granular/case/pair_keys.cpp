// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/pair_keys.hpp"

#include <algorithm>

namespace hilda::granular {

namespace {

using Json = Keys::Json;

template <class Laws>
Laws read_law(Keys& pair, const std::string& kind, const std::string& default_value, const Material& i,
              const Material& j, bool material_normal)
{
    static const Json none = Json::object();
    const bool given = pair.has(kind);
    Keys own(given ? pair.raw(kind) : none, pair.place_of(kind));
    const std::string name = own.text("law", default_value);
    LawKeys keys(own, pair, i, j, material_normal);
    Laws law;
    if (!law.read(name, keys)) own.refuse("law", "must be one of " + Laws::names(), name);
    own.end();
    return law;
}

}  // namespace

std::array<std::size_t, 2> read_between(Keys& pair, const std::vector<Material>& materials)
{
    std::array<std::size_t, 2> ij = {0, 0};
    if (materials.size() == 1 && !pair.has("between")) return ij;
    const Json& names = pair.raw("between");
    if (!names.is_array() || names.size() != 2) pair.refuse("between", "must be two names", names);
    for (std::size_t k = 0; k < 2; ++k) {
        const auto found = std::find_if(materials.begin(), materials.end(), [&](const Material& m) {
            return names[k].is_string() && m.name == names[k].get<std::string>();
        });
        if (found == materials.end())
            pair.refuse("between/" + std::to_string(k), "no material has this name", names[k]);
        ij[k] = static_cast<std::size_t>(found - materials.begin());
    }
    return ij;
}

PairLaw read_pair(Keys& pair, const Material& i, const Material& j, std::vector<std::string>& notices)
{
    PairLaw law;
    if (pair.has("restitution") && pair.number("restitution") == 0)
        notices.push_back(pair.place_of("restitution") +
                          ": 0 is replaced by 1e-7, because the damping of 0 is infinite");
    law.normal = read_law<NormalLaws>(pair, "normal", "hertz", i, j, true);
    const bool material_stiffness = law.normal.is<Hertz>();
    law.tangential = read_law<TangentialLaws>(pair, "tangential", "none", i, j, material_stiffness);
    law.rolling = read_law<RollingLaws>(pair, "rolling", "none", i, j, material_stiffness);
    law.spin = read_law<SpinLaws>(pair, "spin", "none", i, j, material_stiffness);
    law.cohesion = read_law<CohesionLaws>(pair, "cohesion", "none", i, j, material_stiffness);
    const bool spring = !law.tangential.is<NoFriction>();
    const bool has_rotational_spring =
        !(law.rolling.is<NoRolling>() || law.rolling.is<ConstantTorque>()) || !law.spin.is<NoSpin>();
    if (has_rotational_spring && !spring)
        pair.refuse(
            "tangential",
            "must not be none with this rolling or spin law, whose stiffness is that of the tangential law",
            "none");
    if (pair.has("mu_s") && pair.has("mu") && pair.number("mu_s") < pair.number("mu"))
        pair.refuse("mu_s", "must not be less than mu", pair.number("mu_s"));
    for (const char* key : {"mu", "mu_s", "restitution"})
        pair.has(key);  // accepted even if no law reads them
    return law;
}

}  // namespace hilda::granular
