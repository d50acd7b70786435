// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/experiments/sweep/swept_values.hpp"

#include "io/error.hpp"
#include "io/expression.hpp"
#include "io/json_source.hpp"
#include "io/option_values.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace hilda::studies {

namespace {

constexpr size_t most = 100000;

[[noreturn]] void refuse(const std::string& what, const std::string& text)
{
    io::refuse_option("--sweep", what, text);
}

/// The parts between the separators that are outside of parentheses, brackets and quotes
std::vector<std::string> parts(const std::string& text, char separator)
{
    std::vector<std::string> all(1);
    int depth = 0;
    bool quoted = false;
    for (size_t k = 0; k < text.size(); ++k) {
        const char c = text[k];
        if (quoted && c == '\\' && k + 1 < text.size()) {
            (all.back() += c) += text[++k];
            continue;
        }
        if (c == '"') quoted = !quoted;
        if (!quoted && (c == '(' || c == '[' || c == '{')) ++depth;
        if (!quoted && (c == ')' || c == ']' || c == '}') && depth > 0) --depth;
        if (c == separator && !quoted && depth == 0)
            all.emplace_back();
        else
            all.back() += c;
    }
    return all;
}

/// The numbers of A:B:N or A:B:N:log; empty if the text has another form
std::vector<std::string> range(const std::string& text)
{
    const std::vector<std::string> part = parts(text, ':');
    if (part.size() < 3 || part.size() > 4) return {};
    const double a = io::finite_number_in(part[0]), b = io::finite_number_in(part[1]);
    if (std::isnan(a) || std::isnan(b)) return {};
    const bool ratios = part.size() == 4;
    if (ratios && part[3] != "log") refuse("a range is A:B:N or A:B:N:log", text);
    const std::optional<int> n = io::number_in<int>(part[2]);
    if (!n || *n < 2 || *n > static_cast<int>(most))
        refuse("the number N of a range A:B:N must be a whole number from 2 to 100000", text);
    if (a == b) refuse("the limits of a range must differ", text);
    if (ratios && !(a * b > 0)) refuse("the limits of a range A:B:N:log must have the same sign", text);
    std::vector<std::string> values;
    for (int k = 0; k < *n; ++k) {
        const double s = static_cast<double>(k) / (*n - 1);
        // The limits themselves, without rounding errors
        const double value = k == 0        ? a
                             : k == *n - 1 ? b
                             : ratios      ? a * std::pow(b / a, s)
                                           : (a * (*n - 1 - k) + b * k) / (*n - 1);
        values.push_back(io::shortest(value));
    }
    return values;
}

std::string trimmed(const std::string& text)
{
    const size_t first = text.find_first_not_of(' ');
    return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

/// The same text for the same value: of a number, an expression without parameters, a JSON value, or a text
/// with or without quotes
std::string canonical(const std::string& value)
{
    const double number = io::finite_number_in(value);
    if (!std::isnan(number)) return io::shortest(number + 0.);  // -0 becomes 0
    try {
        return io::written(io::JsonSource(value, "").root);
    } catch (const io::InvalidInput&) {  // a text without quotes
    }
    try {
        const io::Expression expression(value, {});
        if (const double x = expression.value(std::span<const double>()); std::isfinite(x))
            return io::shortest(x + 0.);
    } catch (const io::ExpressionError&) {  // a text, or an expression in parameters
    }
    return io::written(io::Json(value));
}

void refuse_equal(const std::vector<std::string>& values, const std::string& text)
{
    std::map<std::string, std::string> known;
    for (const std::string& value : values) {
        const auto [at, is_new] = known.try_emplace(canonical(value), value);
        if (is_new) continue;
        refuse("must contain each value once" +
                   (value == at->second ? "" : ", and " + at->second + " and " + value + " are equal"),
               text);
    }
}

}  // namespace

SweptEntry swept_entry(const std::string& text)
{
    const std::string form = "must be /json/pointer=VALUE,VALUE,... or /json/pointer=A:B:N";
    const size_t equals = text.find('=');
    if (equals == std::string::npos || !text.starts_with('/')) refuse(form, text);
    SweptEntry entry{.pointer = text.substr(0, equals), .values = {}};
    for (const std::string& raw : parts(text.substr(equals + 1), ',')) {
        const std::string part = trimmed(raw);
        if (part.empty()) refuse(form + " without empty values", text);
        const std::vector<std::string> values = range(part);
        if (values.empty())
            entry.values.push_back(part);
        else
            entry.values.insert(entry.values.end(), values.begin(), values.end());
    }
    refuse_equal(entry.values, text);
    return entry;
}

std::vector<SweptEntry> swept_entries(const std::vector<std::string>& texts)
{
    std::vector<SweptEntry> all;
    double count = 1;
    for (const std::string& text : texts) {
        all.push_back(swept_entry(text));
        const std::string& pointer = all.back().pointer;
        for (size_t k = 0; k + 1 < all.size(); ++k)
            if (all[k].pointer == pointer) refuse("is given twice for " + pointer, text);
        count *= static_cast<double>(all.back().values.size());
        if (count > static_cast<double>(most)) refuse("gives more than 100000 combinations", text);
    }
    return all;
}

size_t combinations(const std::vector<SweptEntry>& entries)
{
    size_t count = 1;
    for (const SweptEntry& entry : entries) count *= entry.values.size();
    return count;
}

std::vector<std::string> combination(const std::vector<SweptEntry>& entries, size_t k)
{
    std::vector<std::string> values(entries.size());
    for (size_t e = entries.size(); e-- > 0; k /= entries[e].values.size())
        values[e] = entries[e].values[k % entries[e].values.size()];
    return values;
}

}  // namespace hilda::studies
