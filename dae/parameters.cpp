// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/parameters.hpp"

#include "io/expression.hpp"
#include "io/nearest.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace hilda::dae {

namespace {

/// Reason why a name cannot be that of a parameter, or ""
std::string fault_of_name(const std::string& name)
{
    if (!io::Expression::is_name(name))
        return "the name of a parameter must consist of letters, digits and _ and begin with a letter or _";
    const std::vector<std::string> functions = io::Expression::function_names();
    if (std::find(functions.begin(), functions.end(), name) != functions.end())
        return "the name of a parameter must not be that of a function";
    for (const auto& [word, meaning] :
         {std::pair("t", "the time"), std::pair("pi", "a constant"), std::pair("e", "a constant")})
        if (name == word) return std::string("the name of a parameter must not be ") + word + ", " + meaning;
    return "";
}

}  // namespace

Parameters::Parameters(const io::JsonSource& source) : source(source)
{
    const io::Json::Member* all = source.root.member("parameters");
    if (all == nullptr) return;
    if (all->value.members() == nullptr)
        source.fail(all->value, "/parameters",
                    "parameters must be an object, got " + io::described(all->value));
    for (const io::Json::Member& m : *all->value.members()) {
        if (m.key == "note") continue;
        io::Json at;
        at.offset = m.offset;
        at.change = m.value.change;
        if (const std::string fault = fault_of_name(m.key); !fault.empty())
            source.fail(at, io::pointer_to("/parameters", m.key), fault + ", got " + io::in_quotes(m.key));
        given.push_back(&m);
        names.push_back(m.key);
    }
    if (names.size() > most)
        source.fail(all->value, "/parameters",
                    "at most " + std::to_string(most) + " parameters are allowed, got " +
                        std::to_string(names.size()));
    for (const std::string& name : names) parameters.emplace_back(name, 0);
    known.resize(names.size());
    used.resize(names.size());
    shadowed.resize(names.size());
    std::vector<std::size_t> path;
    for (std::size_t k = 0; k < names.size(); ++k) evaluate(k, path);
}

std::string Parameters::pointer(std::size_t k) const { return io::pointer_to("/parameters", names[k]); }

/// Evaluates parameter k, and before it those that its expression contains. `path`: the parameters that wait
/// for it
void Parameters::evaluate(std::size_t k, std::vector<std::size_t>& path)
{
    if (known[k]) return;
    const io::Json& v = given[k]->value;
    const auto begin = std::find(path.begin(), path.end(), k);
    if (begin != path.end()) {
        std::string cycle;
        for (auto p = begin; p != path.end(); ++p) cycle += names[*p] + " -> ";
        source.fail(v, pointer(k), "the parameters depend on each other in a cycle: " + cycle + names[k]);
    }
    if (v.number() != nullptr) {
        parameters[k].second = *v.number();
    } else if (v.string() == nullptr) {
        source.fail(v, pointer(k),
                    "a parameter must be a number or an expression in a string, got " + io::described(v));
    } else {
        path.push_back(k);
        for (const io::Expression::Name& name : io::Expression::names(*v.string()))
            if (const auto at = std::find(names.begin(), names.end(), name.text); at != names.end())
                evaluate(static_cast<std::size_t>(at - names.begin()), path);
        path.pop_back();
        try {
            parameters[k].second = value(*v.string());
        } catch (const io::ExpressionError& e) {
            source.fail(v, pointer(k), e.what());
        }
    }
    known[k] = true;
}

double Parameters::value(const std::string& expression) const
{
    mark_used(expression);
    // Parameters are constants of the expression, so that messages quote the text of the file.
    const std::vector<std::string> no_variables;
    const double x = io::Expression(expression, no_variables, parameters).value(std::span<const double>());
    if (std::isfinite(x)) return x;
    std::string with;
    for (const io::Expression::Name& name : io::Expression::names(expression)) {
        const auto at = std::find(names.begin(), names.end(), name.text);
        if (at == names.end()) continue;
        const std::string equation = name.text + " = " + io::shortest(parameters[at - names.begin()].second);
        if (with.find(equation) == std::string::npos) with += (with.empty() ? " with " : ", ") + equation;
    }
    throw io::ExpressionError(io::in_quotes(expression) + " must be finite, got " + io::shortest(x) + with,
                              1);
}

/// Throws ExpressionError for a name that is neither a variable nor a parameter nor a constant.
void Parameters::check_known(const std::string& expression, const std::vector<std::string>& variables) const
{
    if (names.empty()) return;  // io::Expression finds unknown names
    std::vector<std::string> all = variables;
    all.insert(all.end(), names.begin(), names.end());
    all.insert(all.end(), {"pi", "e"});
    for (const io::Expression::Name& name : io::Expression::names(expression))
        if (std::find(all.begin(), all.end(), name.text) == all.end())
            throw io::ExpressionError("unknown name '" + name.text + "' in " + io::in_quotes(expression) +
                                          " at column " + std::to_string(name.begin + 1) +
                                          io::did_you_mean(name.text, all),
                                      static_cast<int>(name.begin) + 1);
}

void Parameters::mark_used(const std::string& expression) const
{
    for (const io::Expression::Name& name : io::Expression::names(expression))
        if (const auto at = std::find(names.begin(), names.end(), name.text); at != names.end())
            used[at - names.begin()] = true;
}

std::string Parameters::substituted(const std::string& expression,
                                    const std::vector<std::string>& variables) const
{
    check_known(expression, variables);
    return replaced(expression, variables);
}

std::string Parameters::replaced(const std::string& expression,
                                 const std::vector<std::string>& variables) const
{
    std::string text;
    std::size_t done = 0;
    for (const io::Expression::Name& name : io::Expression::names(expression)) {
        const auto at = std::find(names.begin(), names.end(), name.text);
        if (at == names.end()) continue;
        if (std::find(variables.begin(), variables.end(), name.text) != variables.end()) {
            shadowed[at - names.begin()] = true;
            continue;
        }
        used[at - names.begin()] = true;
        text.append(expression, done, name.begin - done);
        text += '(' + io::shortest(parameters[at - names.begin()].second) + ')';
        done = name.begin + name.text.size();
    }
    return text.append(expression, done);
}

// JsonSource::set() gives an added member the location of the object.
void Parameters::check_added() const
{
    const io::Json::Member* object = source.root.member("parameters");
    for (std::size_t k = 0; k < names.size(); ++k) {
        const bool added = given[k]->value.change >= 0 && given[k]->offset == object->value.offset;
        if (!added || used[k] || shadowed[k]) continue;
        std::vector<std::string> others;
        for (const std::string& name : names)
            if (name != names[k]) others.push_back(name);
        source.fail(given[k]->value, pointer(k),
                    "the model does not use a parameter " + io::in_quotes(names[k]) +
                        io::did_you_mean(names[k], others));
    }
}

std::vector<std::string> Parameters::warnings() const
{
    std::vector<std::string> lines;
    for (std::size_t k = 0; k < names.size(); ++k) {
        const std::string place = source.place(given[k]->value.offset, pointer(k));
        if (shadowed[k])
            lines.push_back(place + ": the parameter " + names[k] +
                            " has the name of a variable of an expression; there it denotes the variable");
        else if (!used[k])
            lines.push_back(place + ": nothing uses the parameter " + names[k]);
    }
    return lines;
}

}  // namespace hilda::dae
