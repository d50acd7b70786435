// SPDX-License-Identifier: GPL-3.0-or-later
/// Output type angle: rotation of one body relative to another about a common axis.
#include "dae/outputs/output.hpp"
#include "dae/outputs/turn_counter.hpp"

#include <utility>

namespace hilda::dae {

namespace {

/// The joint angle of a hinge: rotation of body j relative to body i about the axis since the start. The
/// state counts its whole turns from step to step, also in the internal steps of adaptive schemes.
class AngleOutput final : public Output {
public:
    explicit AngleOutput(std::shared_ptr<TurnCounter> hinge) : hinge(std::move(hinge)) {}

    std::vector<Quantity> quantities() const override
    {
        return {{"angle", "rad", "rotation of body j relative to body i about the axis since the start"},
                {"rate", "rad/s", "rate of the angle"}};
    }
    void values(const State& x, double* out) const override
    {
        out[0] = hinge->angle(x), out[1] = hinge->rate(x);
    }
    std::shared_ptr<TurnCounter> turns() const override { return hinge; }

private:
    const std::shared_ptr<TurnCounter> hinge;
};

const TypeSchema schema_angle = {
    .description =
        "Joint angle: rotation [rad] of body j relative to body i about a common axis since the start, "
        "counted through whole turns, and its rate [rad/s]: the columns NAME.angle and NAME.rate.",
    .examples = {R"("name": "crank angle", "body_i": "ground", "body_j": "crank", "axis_bar_i": [0, 0, 1], )"
                 R"("axis_bar_j": [0, 0, 1])"}};

const bool registered_angle = io::Registry<OutputType>::add(
    {.name = "angle",
     .schema = schema_angle,
     .read = [](ObjectReader& o, const BodyFinder& bodies, const State& x, const std::vector<std::string>&) {
         const auto [i, j] = bodies.pair(o);
         const Axes axis(o);
         return std::unique_ptr<Output>(
             std::make_unique<AngleOutput>(std::make_shared<TurnCounter>(i, axis.i, j, axis.j, x)));
     }});

}  // namespace

}  // namespace hilda::dae
