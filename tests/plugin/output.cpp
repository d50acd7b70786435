// SPDX-License-Identifier: GPL-3.0-or-later
/// An output type of a plug-in: the angular speed of a body.

#include "dae/outputs/output.hpp"

namespace hilda::dae {

namespace {

class AngularSpeed final : public Output {
public:
    explicit AngularSpeed(int body) : body(body) {}

    std::vector<Quantity> quantities() const override
    {
        return {{"omega", "rad/s", "magnitude of the angular velocity"}};
    }
    void values(const State& x, double* out) const override { out[0] = x.body[body].omega_bar.norm(); }

private:
    const int body;
};

const TypeSchema schema = {.description = "Angular speed [rad/s] of a body: the column NAME.omega.",
                           .examples = {R"("name": "turn", "body": "bar")"}};

const bool registered = io::Registry<OutputType>::add(
    {.name = "angular-speed",
     .schema = schema,
     .read = [](ObjectReader& o, const BodyFinder& bodies, const State&, const std::vector<std::string>&) {
         return std::unique_ptr<Output>(
             std::make_unique<AngularSpeed>(bodies.body(o, "body", {"The body.", R"("bar")"})));
     }});

}  // namespace

}  // namespace hilda::dae
