// SPDX-License-Identifier: GPL-3.0-or-later
// A joint and a force that are added to the program by one file: a rope over two fixed pulleys, and drag.
#include "dae/force.hpp"
#include "dae/model_types.hpp"

namespace {

using namespace hilda::dae;

/// A rope of constant length runs from body i over the pulleys P and Q to body j:
///
///     Phi = |d_i| + |d_j| - L,   d_i = r_i - P,   d_j = r_j - Q
///
/// P and Q are points of the ground [m].
class Rope final : public Block {
public:
    Rope(int i, const Vec3& P, int j, const Vec3& Q, double L) : Block(i, j), P(P), Q(Q), L(L) {}

    double phi(const Arguments& x) const override { return (x.bi.r - P).norm() + (x.bj.r - Q).norm() - L; }

    Variation variation(const Arguments& x) const override
    {
        Variation v = Variation::zero();
        v.r_i = (x.bi.r - P).normalized(), v.r_j = (x.bj.r - Q).normalized();
        return v;
    }

    double gamma(const Arguments& x) const override
    {
        const auto part = [](const Vec3& d, const Vec3& ddot) {
            return (std::pow(d.normalized().dot(ddot), 2) - ddot.squaredNorm()) / d.norm();
        };
        return part(x.bi.r - P, x.bi.rdot) + part(x.bj.r - Q, x.bj.rdot);
    }

private:
    const Vec3 P, Q;
    const double L;
};

const TypeSchema rope_schema = {
    .description = "Rope of constant length over two fixed pulleys, one row.",
    .examples = {R"("body_i": "heavy", "body_j": "light", "pulley_i": [0, 0, 1], "pulley_j": [1, 0, 1], )"
                 R"("length": 4)"}};

const bool rope_registered = hilda::io::Registry<ConstraintType>::add(
    {.name = "rope",
     .schema = rope_schema,
     .read = [](ObjectReader& o, int i, int j, const State&) -> ConstraintType::Constraints {
         const Vec3 P = o.vec3("pulley_i", {"Pulley of body i [m], in the global frame.", "[0, 0, 1]"});
         const Vec3 Q = o.vec3("pulley_j", {"Pulley of body j [m], in the global frame.", "[1, 0, 1]"});
         return single_row(
             Rope(i, P, j, Q, o.positive("length", {"Length of the free parts of the rope [m].", "4"})));
     }});

/// F = -c v on the centre of mass of a body
class Drag final : public Force {
public:
    Drag(int body, double c) : body(body), c(c) {}
    void add(const State& x, hilda::lie::Loads& out) const override { out.F[body] -= c * x.body[body].rdot; }
    int last_body() const override { return body; }

private:
    const int body;
    const double c;
};

const TypeSchema drag_schema = {.description = "Drag proportional to the velocity of the centre of mass.",
                                .examples = {R"("body": "light", "coefficient": 0.1)"}};

const bool drag_registered = hilda::io::Registry<ForceType>::add(
    {.name = "drag",
     .schema = drag_schema,
     .read = [](ObjectReader& o, const BodyFinder& bodies, const State&) -> std::unique_ptr<Force> {
         const int b = bodies.body(o, "body", {"The body.", R"("light")"});
         if (b == ground) o.fail("body", "drag must act on a movable body, got 'ground'");
         return std::make_unique<Drag>(b, o.positive("coefficient", {"Coefficient c [N s/m].", "0.1"}));
     }});

}  // namespace
