// SPDX-License-Identifier: GPL-3.0-or-later
/// Driver from a constant, and its complement.

#include "dae/driver.hpp"

#include <charconv>

namespace hilda::dae {
namespace {

/// The shortest text that reads back as the same number.
std::string shortest(double c)
{
    char digits[32];
    return {digits, std::to_chars(digits, digits + sizeof digits, c).ptr};
}

}  // namespace

Driver::Driver(double constant) : Driver(shortest(constant)) {}

Driver::Driver(std::string_view text) : expression(std::make_shared<const Expression>(text))
{
    constant = expression->is_constant();
    if (constant) value = expression->value(0);
}

std::optional<Driver> Driver::complement() const
{
    const std::string_view outer = expression->outermost();
    if (outer != "cos" && outer != "sin") return std::nullopt;
    // Only blanks, '(' and '+' can stand before the outermost function.
    std::string swapped = text();
    swapped.replace(swapped.find(outer), outer.size(), outer == "cos" ? "sin" : "cos");
    return Driver(swapped);
}

}  // namespace hilda::dae
