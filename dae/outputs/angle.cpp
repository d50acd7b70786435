// SPDX-License-Identifier: GPL-3.0-or-later
/// Output type angle: rotation of one body relative to another about a common axis.
#include "dae/constraints/angle.hpp"
#include "dae/forces/hinge_force.hpp"
#include "dae/outputs/output.hpp"

#include <cmath>

namespace hilda::dae {

namespace {

/// The joint angle of a hinge: rotation of body j relative to body i about the axis since the start, counted
/// through whole turns from node to node. The number of turns is that of the angle nearest to the prediction
/// by the mean of the rates of both nodes. It is right as long as the prediction is right to half a turn.
class AngleOutput final : public Output {
public:
    AngleOutput(int i, const Vec3& axis_bar_i, int j, const Vec3& axis_bar_j, const State& start)
        : hinge(i, axis_bar_i, j, axis_bar_j, start)
    {}

    std::vector<Quantity> quantities() const override
    {
        return {{"angle", "rad", "rotation of body j relative to body i about the axis since the start"},
                {"rate", "rad/s", "rate of the angle"}};
    }

    /// Angle [rad], time [s] and rate [rad/s] of the last node; the time is not used at the start
    int saved_numbers() const override { return 3; }
    void update(const State& x, double* saved) const override
    {
        const double rate = hinge.rate(x);
        saved[0] = hinge.nearest(x, saved[0] + (x.t - saved[1]) * 0.5 * (saved[2] + rate));
        saved[1] = x.t, saved[2] = rate;
    }
    void values(const State& x, const double* saved, double* out) const override
    {
        out[0] = hinge.nearest(x, saved[0]), out[1] = hinge.rate(x);
    }

private:
    /// The geometry of a hinge force without its torque
    class Hinge final : public HingeForce {
    public:
        Hinge(int i, const Vec3& axis_bar_i, int j, const Vec3& axis_bar_j, const State& start)
            : HingeForce("angle", i, axis_bar_i, j, axis_bar_j, start)
        {}
        double torque(double, double) const override { return 0; }
        double potential(double) const override { return 0; }

        /// Of the angles that differ by whole turns, the one nearest to `angle`
        double nearest(const State& x, double angle) const
        {
            const Vec3 u_j = motion(x, i).A.transpose() * (motion(x, j).A * u_bar_j);
            return nearest_revolution(std::atan2(v_bar_i.dot(u_j), u_bar_i.dot(u_j)), angle);
        }
    };

    const Hinge hinge;
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
         return std::unique_ptr<Output>(std::make_unique<AngleOutput>(i, axis.i, j, axis.j, x));
     }});

}  // namespace

}  // namespace hilda::dae
