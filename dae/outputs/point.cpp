// SPDX-License-Identifier: GPL-3.0-or-later
/// Output type point: position, velocity and acceleration of a point of a body.
#include "dae/outputs/output.hpp"

namespace hilda::dae {

namespace {

/// Point P of a body, in the frame of another body or in the global frame:
///
///     d     = r + A s_bar                         position of P, global
///     ddot  = rdot + A (omega_bar × s_bar)
///     dddot = rddot + A (omegadot_bar × s_bar + omega_bar × (omega_bar × s_bar))
///
/// and, relative to body k, as an observer on that body sees it:
///
///     p     = A_kᵀ (d - r_k)
///     pdot  = A_kᵀ (ddot - rdot_k) - omega_k × p
///     pddot = A_kᵀ (dddot - rddot_k) - omegadot_k × p - omega_k × (omega_k × p) - 2 omega_k × pdot
class PointOutput final : public Output {
public:
    PointOutput(int body, const Vec3& s_bar, int observer) : body(body), observer(observer), s_bar(s_bar) {}

    std::vector<Quantity> quantities() const override
    {
        const std::string frame =
            observer == ground ? ", global frame" : ", relative to and in the frame of the observer";
        std::vector<Quantity> all;
        for (const char* axis : {"x", "y", "z"}) all.push_back({axis, "m", "position of the point" + frame});
        for (const char* axis : {"vx", "vy", "vz"})
            all.push_back({axis, "m/s", "velocity of the point" + frame});
        for (const char* axis : {"ax", "ay", "az"})
            all.push_back({axis, "m/s^2", "acceleration of the point" + frame});
        return all;
    }

    void values(const State& x, double* out) const override
    {
        const Motion &b = motion(x, body), &k = motion(x, observer);
        const Vec3 &w = b.omega_bar, &w_k = k.omega_bar;
        const Vec3 d = b.r + b.A * s_bar, ddot = b.rdot + b.A * w.cross(s_bar);
        const Vec3 dddot = b.rddot + b.A * (b.omegadot_bar.cross(s_bar) + w.cross(w.cross(s_bar)));
        const Vec3 p = k.A.transpose() * (d - k.r);
        const Vec3 pdot = k.A.transpose() * (ddot - k.rdot) - w_k.cross(p);
        Vec3::Map(out) = p;
        Vec3::Map(out + 3) = pdot;
        Vec3::Map(out + 6) = k.A.transpose() * (dddot - k.rddot) - k.omegadot_bar.cross(p) -
                             w_k.cross(w_k.cross(p)) - 2 * w_k.cross(pdot);
    }

private:
    const int body, observer;
    const Vec3 s_bar;
};

const TypeSchema schema_point = {
    .description =
        "Position [m], velocity [m/s] and acceleration [m/s^2] of a point of a body: the columns NAME.x, "
        "y, z, vx, vy, vz, ax, ay, az.",
    .examples = {R"("name": "tip", "body": "bar", "point_bar": [0.5, 0, 0])"}};

const bool registered_point = io::Registry<OutputType>::add(
    {.name = "point",
     .schema = schema_point,
     .read = [](ObjectReader& o, const BodyFinder& bodies, const State&, const std::vector<std::string>&) {
         const int body = bodies.body(o, "body", {"The body.", R"("bar")"});
         const Vec3 s_bar = o.vec3("point_bar", {"The point in the body frame [m]."}, Vec3::Zero());
         const int observer = o.given("observer")
                                  ? bodies.body(o, "observer",
                                                {"The motion is relative to this body and in its frame.",
                                                 R"("ground")", R"("default": "ground")"})
                                  : ground;
         if (body == observer) o.fail("observer", "body and observer must be different, got one body twice");
         return std::unique_ptr<Output>(std::make_unique<PointOutput>(body, s_bar, observer));
     }});

}  // namespace

}  // namespace hilda::dae
