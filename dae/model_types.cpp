// SPDX-License-Identifier: GPL-3.0-or-later
/// Reading of drivers, and the registered reader of contacts.
#include "dae/model_types.hpp"

#include "dae/driver.hpp"
#include "io/jet.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

namespace hilda::dae {

Driver read_driver(ObjectReader& o, std::string_view key, const std::optional<std::string>& fallback)
{
    const std::string text = o.formula(key, fallback);
    try {
        Driver f(text);
        const io::Jet start = f.jet(0);
        if (!std::isfinite(f.f(0)) || !std::isfinite(start.fdot) || !std::isfinite(start.fddot))
            o.fail(key, std::string(key) + " and its derivatives must be finite at t = 0, got " +
                            described(text) + " with the value " + shortest(f.f(0)) +
                            " and the derivatives " + shortest(start.fdot) + ", " + shortest(start.fddot));
        return f;
    } catch (const io::ExpressionError& e) {
        o.fail(key, e.what());
    }
}

std::string type_with_other_name(const std::string& name)
{
    static const std::map<std::string, std::string> known = {{"prismatic", "translational"},
                                                             {"slider", "translational"},
                                                             {"hinge", "revolute"},
                                                             {"pin", "revolute"},
                                                             {"ball", "spherical"},
                                                             {"ball-and-socket", "spherical"},
                                                             {"cardan", "universal"},
                                                             {"hooke", "universal"},
                                                             {"weld", "fixed"},
                                                             {"rigid", "fixed"},
                                                             {"rod", "distance"},
                                                             {"link", "distance"},
                                                             {"helical", "screw"},
                                                             {"motor", "hinge-driver"},
                                                             {"spring", "spring-damper"},
                                                             {"damper", "spring-damper"},
                                                             {"tsda", "spring-damper"},
                                                             {"rsda", "torsion-spring"},
                                                             {"moment", "torque"}};
    std::string lower = name;
    std::transform(lower.begin(), lower.end(), lower.begin(),
                   [](unsigned char c) { return c == '_' ? '-' : static_cast<char>(std::tolower(c)); });
    const auto found = known.find(lower);
    return found != known.end() ? found->second : "";
}

namespace {

// A function-local variable is initialised before its first use, also during static initialisation.
ReadContact& registered()
{
    static ReadContact read = nullptr;
    return read;
}

}  // namespace

bool register_contact_reader(ReadContact read)
{
    registered() = read;
    return true;
}

ReadContact contact_reader() { return registered(); }

}  // namespace hilda::dae

template class hilda::io::Registry<hilda::dae::ConstraintType>;
template class hilda::io::Registry<hilda::dae::ForceType>;
