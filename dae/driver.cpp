// SPDX-License-Identifier: GPL-3.0-or-later
/// Construction of a driver and of its complement.

#include "dae/driver.hpp"

#include "dae/curves/sampled_curve.hpp"
#include "dae/function_of_time.hpp"
#include "io/json.hpp"

#include <limits>
#include <utility>

namespace hilda::dae {

Driver::Driver(double constant) : Driver(io::shortest(constant)) {}

Driver::Driver(std::string_view text) : expression(std::make_shared<const io::Expression>(text))
{
    constant = expression->is_constant();
    if (constant) value = expression->value(0);
}

Driver::Driver(std::shared_ptr<const SampledCurve> samples) : constant(false), curve(std::move(samples)) {}

io::Jet Driver::jet(double t) const { return curve ? curve->jet(t) : expression->jet(t); }

double Driver::last_time() const { return curve ? curve->last() : std::numeric_limits<double>::infinity(); }

FunctionOfTime Driver::function_of_time() const
{
    return curve ? FunctionOfTime(curve) : FunctionOfTime(*expression);
}

const std::string& Driver::text() const
{
    static const std::string none;
    return expression ? expression->text() : none;
}

std::optional<Driver> Driver::complement() const
{
    if (curve) return std::nullopt;
    const std::string_view outer = expression->outermost();
    if (outer != "cos" && outer != "sin") return std::nullopt;
    // Only blanks, '(' and '+' can precede the outermost function in the text.
    std::string complement_text = text();
    complement_text.replace(complement_text.find(outer), outer.size(), outer == "cos" ? "sin" : "cos");
    return Driver(complement_text);
}

}  // namespace hilda::dae
