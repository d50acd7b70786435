// SPDX-License-Identifier: GPL-3.0-or-later
/// Compliant limits of a distance and of an angle.
#include "dae/forces/limits.hpp"

#include "dae/forces/row_load.hpp"
#include "dae/model_types.hpp"
#include "lie/check.hpp"

namespace hilda::dae {

Vec3 DistanceLimit::d_ij(const State& x) const
{
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    return bj.r + bj.A * s_bar_j - bi.r - bi.A * s_bar_i;
}

Vec3 DistanceLimit::d_ijdot(const State& x) const
{
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    return velocity_at(bj, bj.A * s_bar_j) - velocity_at(bi, bi.A * s_bar_i);
}

void DistanceLimit::add(const State& x, lie::Loads& out) const
{
    const Vec3 d = d_ij(x);
    const double l = d.norm();
    if (!(l > 0)) {
        if (stop.force(l, 0) == 0) return;
        throw lie::NonFinite(label() + ": the two points coincide, so that the force has no direction");
    }
    const Vec3 along = d / l, F = stop.force(l, along.dot(d_ijdot(x))) * along;
    apply_force(i, F, s_bar_i, x, out);
    apply_force(j, -F, s_bar_j, x, out);
}

void DistanceLimit::switching(const State& x, double* out) const
{
    const Vec3 d = d_ij(x);
    const double l = d.norm();
    stop.switching(l, l > 0 ? d.dot(d_ijdot(x)) / l : 0, out);
}

int DistanceLimit::spring_rows(const State& x, SpringRow* out) const
{
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    const Vec3 d = d_ij(x);
    if (!(d.norm() > 0)) return 0;
    const Vec3 along = d.normalized();
    out[0] = {.r_i = -along,
              .pi_i = -s_bar_i.cross(bi.A.transpose() * along),
              .r_j = along,
              .pi_j = s_bar_j.cross(bj.A.transpose() * along),
              .stiffness = stop.stiffness};
    return 1;
}

bool DistanceLimit::load_derivatives(const State& x, LoadDerivatives& out) const
{
    const double l = d_ij(x).norm();
    out.setZero();
    if (!(l > 0) || stop.is_within(l)) return true;
    const double ldot = d_ij(x).dot(d_ijdot(x)) / l;
    const auto [by_l, by_ldot] = stop.derivatives(l, ldot);
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    distance_row(bi, s_bar_i, bj, s_bar_j)
        .add_to(stop.force(l, ldot), by_l, by_ldot, velocities(bi, bj), out);
    return true;
}

double DistanceLimit::stable_step(const State& x, LoadEvaluation evaluation) const
{
    return stop.is_within(d_ij(x).norm()) ? std::numeric_limits<double>::infinity()
                                          : Force::stable_step(x, evaluation);
}

double AngleLimit::stable_step(const State& x, LoadEvaluation evaluation) const
{
    return stop.is_within(angle(x)) ? std::numeric_limits<double>::infinity()
                                    : Force::stable_step(x, evaluation);
}

double DistanceLimit::potential_energy(const State& x) const { return stop.potential(d_ij(x).norm()); }

std::vector<Quantity> DistanceLimit::quantities() const
{
    return {{"length", "m", "distance of the two points"},
            {"rate", "m/s", "rate of the distance, positive while it grows; 0 while the points coincide"},
            {"force", "N", "force of the limit, positive if it pulls the bodies together"}};
}

void DistanceLimit::values(const State& x, double* out) const
{
    const Vec3 d = d_ij(x);
    out[0] = d.norm();
    out[1] = out[0] > 0 ? d.dot(d_ijdot(x)) / out[0] : 0;
    out[2] = stop.force(out[0], out[1]);
}

namespace {

/// The descriptions of the keys of a stop
struct StopKeys {
    About minimum, maximum, stiffness, damping;
};

/// The keys of a stop. At least one limit must be given.
Stop read_stop(ObjectReader& o, const StopKeys& about)
{
    Stop stop;
    if (o.given("minimum")) stop.minimum = o.number("minimum", about.minimum);
    if (o.given("maximum")) stop.maximum = o.number("maximum", about.maximum);
    if (!o.given("minimum") && !o.given("maximum"))
        o.fail("one of the keys minimum and maximum must be given");
    if (!(stop.minimum < stop.maximum))
        o.fail("maximum", "maximum must be above minimum = " + shortest(stop.minimum) + ", got " +
                              shortest(stop.maximum));
    stop.stiffness = o.positive("stiffness", about.stiffness);
    stop.damping = o.not_negative("damping", about.damping, 0);
    return stop;
}

constexpr const char* one_limit = R"("anyOf": [{"required": ["minimum"]}, {"required": ["maximum"]}])";

const TypeSchema distance_schema = {
    .description =
        "Compliant limits of the distance l of points P and Q. Beyond a limit, by delta, the force "
        "k delta max(0, 1 + d deltadot) pushes the points back; within the limits there is no force. It "
        "models a slack rope, a bump stop or a telescope. At least one limit must be given.",
    .examples = {R"("body_i": "ground", "body_j": "load", "maximum": 0.5, "stiffness": 1e5, "damping": 0.5)"},
    .rest = one_limit};

const bool distance_registered = io::Registry<ForceType>::add(
    {.name = "distance-limit",
     .schema = distance_schema,
     .read = [](ObjectReader& o, const BodyFinder& bodies, const State&) -> std::unique_ptr<Force> {
         const auto [i, j] = bodies.pair(o);
         const Points s(o);
         return std::make_unique<DistanceLimit>(
             i, s.i, j, s.j,
             read_stop(o, {.minimum = {"Smallest distance [m].", "0.1"},
                           .maximum = {"Largest distance [m]. It must be above the minimum.", "0.5"},
                           .stiffness = {"Stiffness k [N/m].", "1e5"},
                           .damping = {"Damping d [s/m].", "0.5"}}));
     }});

const TypeSchema angle_schema = {
    .description =
        "Compliant limits of the rotation theta of body j relative to body i about a common axis since "
        "the start. Beyond a limit, by delta, the torque k delta max(0, 1 + d deltadot) turns the bodies "
        "back; within the limits there is no torque. The angle is counted through whole turns. One step "
        "must rotate the bodies by less than three eighths of a turn. At least one limit must be given.",
    .examples = {R"("body_i": "ground", "body_j": "door", "axis_bar_i": [0, 0, 1], "axis_bar_j": [0, 0, 1], )"
                 R"("maximum": 1.5, "stiffness": 1e3)"},
    .rest = one_limit};

const bool angle_registered = io::Registry<ForceType>::add(
    {.name = "angle-limit",
     .schema = angle_schema,
     .read = [](ObjectReader& o, const BodyFinder& bodies, const State& x) -> std::unique_ptr<Force> {
         const auto [i, j] = bodies.pair(o);
         const Axes axis(o);
         return std::make_unique<AngleLimit>(
             i, axis.i, j, axis.j,
             read_stop(o, {.minimum = {"Smallest angle [rad].", "-0.5"},
                           .maximum = {"Largest angle [rad]. It must be above the minimum.", "0.5"},
                           .stiffness = {"Stiffness k [N m/rad].", "1e3"},
                           .damping = {"Damping d [s/rad].", "0.1"}}),
             x);
     }});

}  // namespace

}  // namespace hilda::dae
