// SPDX-License-Identifier: GPL-3.0-or-later
/// An adaptive scheme for tests, which is not registered.

#pragma once

#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/system.hpp"

namespace hilda::tests {

/// Steps of rA-half-2 of at most sqrt(rtol) seconds
class InnerSteps final : public lie::Integrator {
public:
    InnerSteps(const lie::System& model, const lie::Settings& settings)
        : inner(lie::scheme("rA-half-2").make(model, settings)), most(std::sqrt(settings.rtol))
    {}

    int step(lie::State& x, double h) override
    {
        const long steps = std::max(1L, std::lround(std::ceil(h / most)));
        int iterations = 0;
        for (long k = 0; k < steps; ++k) iterations += inner->step(x, h / static_cast<double>(steps));
        return iterations;
    }
    bool is_staggered() const override { return inner->is_staggered(); }
    void fill_node(lie::State& node, const lie::State& after) const override
    {
        inner->fill_node(node, after);
    }
    const lie::System& system() const override { return inner->system(); }
    lie::Statistics statistics() const override { return inner->statistics(); }

private:
    std::unique_ptr<lie::Integrator> inner;
    const double most;  ///< [s]
};

inline const lie::Scheme inner_steps = {
    .name = "inner-steps",
    .order = 2,
    .order_lambda = 2,
    .formulation = "rA",
    .unknowns = "",
    .uses = {"--tolerance", "--max-iterations", "--linear-solver", "--rtol", "--atol"},
    .source = "",
    .adaptive = true,
    .construct = [](const lie::System& s, const lie::Settings& settings) -> std::unique_ptr<lie::Integrator> {
        return std::make_unique<InnerSteps>(s, settings);
    }};

/// Names of the registered adaptive schemes
inline std::vector<std::string> adaptive_schemes()
{
    std::vector<std::string> names;
    for (const lie::Scheme& s : lie::schemes())
        if (s.adaptive) names.push_back(s.name);
    return names;
}

}  // namespace hilda::tests
