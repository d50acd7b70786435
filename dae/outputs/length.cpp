// SPDX-License-Identifier: GPL-3.0-or-later
/// Output type length: distance of two points and its rate.
#include "dae/outputs/output.hpp"

namespace hilda::dae {

namespace {

/// l = |d_ij| and ldot = d_ij · ddot_ij / l of point P of body i and point Q of body j. ldot is 0 where the
/// points coincide.
class LengthOutput final : public Output {
public:
    LengthOutput(int i, const Vec3& s_bar_i, int j, const Vec3& s_bar_j)
        : i(i), j(j), s_bar_i(s_bar_i), s_bar_j(s_bar_j)
    {}

    std::vector<Quantity> quantities() const override
    {
        return {{"length", "m", "distance of the two points"},
                {"rate", "m/s", "rate of the distance; 0 while the points coincide"}};
    }

    void values(const State& x, double* out) const override
    {
        const Motion &bi = motion(x, i), &bj = motion(x, j);
        const Vec3 s_i = bi.A * s_bar_i, s_j = bj.A * s_bar_j;
        const Vec3 d = bj.r + s_j - bi.r - s_i;
        out[0] = d.norm();
        out[1] = out[0] > 0 ? d.dot(velocity_at(bj, s_j) - velocity_at(bi, s_i)) / out[0] : 0;
    }

private:
    const int i, j;
    const Vec3 s_bar_i, s_bar_j;
};

const TypeSchema schema_length = {
    .description =
        "Distance [m] of points P and Q of two bodies and its rate [m/s]: the columns "
        "NAME.length and NAME.rate.",
    .examples = {R"("name": "stroke", "body_i": "ground", "body_j": "slider")"}};

const bool registered_length = io::Registry<OutputType>::add(
    {.name = "length",
     .schema = schema_length,
     .read = [](ObjectReader& o, const BodyFinder& bodies, const State&, const std::vector<std::string>&) {
         const auto [i, j] = bodies.pair(o);
         const Points s(o);
         return std::unique_ptr<Output>(std::make_unique<LengthOutput>(i, s.i, j, s.j));
     }});

}  // namespace

}  // namespace hilda::dae
