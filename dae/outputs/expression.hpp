// SPDX-License-Identifier: GPL-3.0-or-later
/// A formula in the columns of the run, as an output or as the function of an event.

#pragma once

#include "dae/outputs/output.hpp"

#include <utility>

namespace hilda::dae {

class ExpressionOutput final : public Output {
public:
    ExpressionOutput(std::string text, std::string unit) : text(std::move(text)), unit(std::move(unit)) {}

    std::vector<Quantity> quantities() const override { return {{"", unit, text}}; }
    void values(const State&, double*) const override {}
    std::string expression() const override { return text; }

private:
    const std::string text, unit;
};

}  // namespace hilda::dae
