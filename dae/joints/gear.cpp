// SPDX-License-Identifier: GPL-3.0-or-later
/// Gear pair with parallel axes.                                              Haug (1989), Sec. 3.4.1
#include "dae/constraints/angle.hpp"
#include "dae/joints.hpp"
#include "dae/joints/rows.hpp"
#include "dae/model_types.hpp"
#include "lie/check.hpp"

#include <sstream>

namespace hilda::dae {

namespace {

/// The pitch circles of two gears roll on each other without slip:
///
///     Phi = R_i phi_i + R_j phi_j - C                                        [m]
///
/// phi_i is the angle of the line of centres from P (body i) to Q (body j), measured in body i about its
/// axis; phi_j that of the line from Q to P, measured in body j. R_i and R_j are the pitch radii; R_j is
/// negative if body j is an internal gear (ring). C makes Phi zero in the initial data.
///
/// The line of centres may rotate, so that the gears of a planetary gear train need no carrier here. Both
/// angles are counted over any number of revolutions, as internal states. A step may change each by less than
/// π.
class GearRow final : public Block {
public:
    GearRow(int i, const Vec3& s_bar_i, const AngleFrame& frame_i, double R_i, int j, const Vec3& s_bar_j,
            const AngleFrame& frame_j, double R_j)
        : Block(i, j), s_bar_i(s_bar_i), s_bar_j(s_bar_j), frame_i(frame_i), frame_j(frame_j), R_i(R_i),
          R_j(R_j)
    {}

    int internal_states() const override { return 2; }
    void update_internal_state(const Arguments& x, bool, double* saved) const override
    {
        saved[0] = angle_i(x).value, saved[1] = angle_j(x).value;
    }

    double phi(const Arguments& x) const override
    {
        return R_i * angle_i(x).value + R_j * angle_j(x).value - C;
    }

    Variation variation(const Arguments& x) const override
    {
        const Variation a = angle_i(x).variation, b = angle_j(x).variation;  // b: body j first
        return {.r_i = R_i * a.r_i + R_j * b.r_j,
                .pi_i = R_i * a.pi_i + R_j * b.pi_j,
                .r_j = R_i * a.r_j + R_j * b.r_i,
                .pi_j = R_i * a.pi_j + R_j * b.pi_i};
    }

    double gamma(const Arguments& x) const override
    {
        return -(R_i * angle_i(x).quadratic + R_j * angle_j(x).quadratic);
    }

    std::string start_error(const Arguments& x) const override
    {
        const Vec3 d = x.bj.r + x.bj.A * s_bar_j - x.bi.r - x.bi.A * s_bar_i;
        const Vec3 axis = x.bi.A * frame_i.u_bar.cross(frame_i.w_bar);
        const double distance = axis.cross(d).norm(), expected = std::abs(R_i + R_j);
        if (std::abs(distance - expected) <= 0.01 * expected) return {};
        std::ostringstream text;
        text << "the pitch circles must touch: the distance of the centres must be " << expected
             << " m to within 1 %, got " << distance << " m";
        return text.str();
    }

    double C = 0;  ///< [m]

private:
    static double saved(const Arguments& x, int k) { return x.internal_state ? x.internal_state[k] : 0; }
    Angle angle_i(const Arguments& x) const
    {
        return angle_of_points(frame_i, x.bi, s_bar_i, x.bj, s_bar_j, saved(x, 0));
    }
    Angle angle_j(const Arguments& x) const
    {
        return angle_of_points(frame_j, x.bj, s_bar_j, x.bi, s_bar_i, saved(x, 1));
    }

    const Vec3 s_bar_i, s_bar_j;
    const AngleFrame frame_i, frame_j;
    const double R_i, R_j;
};

}  // namespace

Blocks gear(int i, const Vec3& s_bar_i, const Vec3& axis_bar_i, double R_i, int j, const Vec3& s_bar_j,
            const Vec3& axis_bar_j, double R_j, const State& x)
{
    for (const double R : {R_i, R_j})
        if (R == 0 || !std::isfinite(R)) lie::reject("gear pair", "a pitch radius must not be zero [m]", R);
    if (R_i + R_j == 0)
        lie::reject("gear pair", "the gears of an internal pair must have different radii", R_i);
    const Vec3 axis_i = motion(x, i).A * unit(axis_bar_i), axis_j = motion(x, j).A * unit(axis_bar_j);
    const double cosine = axis_i.dot(axis_j);
    if (!(std::abs(cosine) > 0.999))
        lie::reject("gear pair", "the two axes must be parallel at the start; cosine of their angle", cosine);
    const Perpendicular p_i(axis_bar_i), p_j(cosine > 0 ? axis_bar_j : Vec3(-axis_bar_j));
    GearRow row(i, s_bar_i, {p_i.first, p_i.second}, R_i, j, s_bar_j, {p_j.first, p_j.second}, R_j);
    row.C = row.phi({motion(x, i), motion(x, j), x.t});
    return single_row(std::move(row));
}

namespace {

const TypeSchema schema_gear = {
    .description =
        "Gear pair, one row: the pitch circles of two gears with parallel axes roll on each other without "
        "slip. The circle of body i has the centre P, that of body j the centre Q. Add revolute joints "
        "to the ground or to a carrier for the bearings; the line of centres may rotate, as in a "
        "planetary gear train. The angles are counted through whole turns. One step must rotate each "
        "gear by less than half a turn relative to the line of centres.",
    .examples = {R"("body_i": "pinion", "body_j": "wheel", "axis_bar_i": [1, 0, 0], )"
                 R"("axis_bar_j": [1, 0, 0], "radius_i": 0.1, "radius_j": 0.2)"}};

const bool registered_gear = io::Registry<ConstraintType>::add(
    {.name = "gear",
     .schema = schema_gear,
     .read = [](ObjectReader& o, int i, int j, const State& x) -> ConstraintType::Constraints {
         const Points s(o);
         const Axes axis(o);
         const double R_i = o.positive("radius_i", {"Pitch radius of the gear of body i [m].", "0.1"}),
                      R_j = o.positive("radius_j", {"Pitch radius of the gear of body j [m].", "0.2"});
         return gear(
             i, s.i, axis.i, R_i, j, s.j, axis.j,
             o.flag("internal",
                    {"Whether body j is an internal gear (ring) around the gear of body i.", "true"}, false)
                 ? -R_j
                 : R_j,
             x);
     }});

}  // namespace

}  // namespace hilda::dae
