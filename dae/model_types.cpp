// SPDX-License-Identifier: GPL-3.0-or-later
/// Reading of drivers, and the registered reader of contacts.
#include "dae/model_types.hpp"

#include "dae/driver.hpp"
#include "io/expression.hpp"
#include "io/jet.hpp"

#include <cmath>

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

std::array<io::Expression, 3> read_expressions(ObjectReader& o, std::string_view key,
                                               const std::vector<std::string>& variables)
{
    std::string names;
    for (const std::string& name : variables) names += (names.empty() ? "" : ", ") + name;
    const Json::List& list = o.list(key, true);
    if (list.size() != 3)
        o.fail(key, std::string(key) + " must be three numbers or expressions in " + names +
                        ", got a list of " + std::to_string(list.size()));
    const auto component = [&](size_t k) {
        const Json& v = list[k];
        if (v.number() == nullptr && v.string() == nullptr)
            o.fail(key, k, "a component must be a number or an expression in a string, got " + described(v));
        try {
            return io::Expression(v.number() != nullptr ? shortest(*v.number()) : *v.string(), variables);
        } catch (const io::ExpressionError& e) {
            o.fail(key, k, e.what());
        }
    };
    o.record(key, list);
    return {component(0), component(1), component(2)};
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
