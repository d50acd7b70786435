// SPDX-License-Identifier: GPL-3.0-or-later
/// Type spring-damper of the model file.
#include "dae/forces/spring_damper.hpp"

#include "dae/forces/row_load.hpp"
#include "dae/model_types.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace hilda::dae {

int SpringDamper::spring_rows(const State& x, SpringRow* out) const
{
    if (!(distance(x).squaredNorm() > 0)) return 0;
    const Stretch at = stretch(x);
    const auto [by_l, by_ldot] = coefficients(at, x.t);
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    const Vec3 s_i = bi.A * s_bar_i, s_j = bj.A * s_bar_j, omega_i = bi.A * bi.omega_bar,
               omega_j = bj.A * bj.omega_bar;
    const Vec3 ddot = velocity_at(bj, s_j) - velocity_at(bi, s_i),
               dddot = omega_j.cross(omega_j.cross(s_j)) - omega_i.cross(omega_i.cross(s_i));
    out[0] = {.r_i = -at.along,
              .pi_i = -s_bar_i.cross(bi.A.transpose() * at.along),
              .r_j = at.along,
              .pi_j = s_bar_j.cross(bj.A.transpose() * at.along),
              .stiffness = by_l,
              .damping = by_ldot,
              .gamma = at.along.dot(dddot) + (ddot.squaredNorm() - at.ldot * at.ldot) / at.l};
    return 1;
}

std::pair<double, double> SpringDamper::coefficients(const Stretch& at, double t) const
{
    if (!law) return {stiffness, damping};
    using Variables = std::array<double, 3>;
    const Variables here = {at.l, at.ldot, t};
    const auto F = [&](const Variables& x) { return law->value(x, start_time); };
    // A difference over a jump would be a large slope.
    const auto is_on_this_side = [&](const Variables& x) {
        return std::all_of(switching_functions.begin(), switching_functions.end(),
                           [&](const auto& g) { return (g.value(x) > 0) == (g.value(here) > 0); });
    };
    const auto slope = [&](size_t k, double step) {
        Variables less = here, more = here;
        less[k] -= step, more[k] += step;
        if (!is_on_this_side(less)) less = here;
        if (!is_on_this_side(more)) more = here;
        return less == more ? 0 : (F(more) - F(less)) / (more[k] - less[k]);
    };
    return {stiffness + slope(0, 1e-6 * at.l), damping + slope(1, 1e-6 * std::max(1., std::abs(at.ldot)))};
}

void SpringDamper::set_law(const io::Expression& F)
{
    constexpr size_t time = 2;
    law.emplace(F, time);
    switching_functions = F.switching_functions();
    std::erase_if(switching_functions, [](const io::Expression& g) { return !g.uses(0) && !g.uses(1); });
}

void SpringDamper::switching(const State& x, double* out) const
{
    const Stretch at = stretch(x);
    const double variables[] = {at.l, at.ldot, x.t};
    for (const io::Expression& g : switching_functions) *out++ = g.value(variables);
}

std::vector<io::Expression> SpringDamper::functions_of_time() const
{
    return law ? law->formula.parts_in(2) : std::vector<io::Expression>();
}

bool SpringDamper::load_derivatives(const State& x, LoadDerivatives& out) const
{
    const Stretch at = stretch(x);
    const auto [by_l, by_ldot] = coefficients(at, x.t);
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    out.setZero();
    distance_row(bi, s_bar_i, bj, s_bar_j).add_to(at.f, by_l, by_ldot, velocities(bi, bj), out);
    return true;
}

namespace {

const TypeSchema schema_spring_damper = {
    .description =
        "Spring, damper and actuator between points P and Q. The force k (l - l_0) + c ldot + F acts "
        "along the line from P to Q; l is the distance of the points. A positive force pulls the "
        "bodies together. The run stops with an error if the points coincide.",
    .examples = {R"("body_i": "ground", "body_j": "slider", "stiffness": 1000, )"
                 R"("damping": 10, "free_length": 0.3)"}};

const bool registered_spring_damper = io::Registry<ForceType>::add(
    {.name = "spring-damper",
     .schema = schema_spring_damper,
     .read = [](ObjectReader& o, const BodyFinder& bodies, const State&) -> std::unique_ptr<Force> {
         const auto [i, j] = bodies.pair(o);
         const Points s(o);
         const double k = o.not_negative("stiffness", {"Stiffness k [N/m].", "1000"}),
                      c = o.not_negative("damping", {"Damping coefficient c [N s/m].", "10"}, 0);
         SpringDamper spring(i, s.i, j, s.j, k, c,
                             o.not_negative("free_length", {"Free length l_0 [m].", "0.3"}));
         if (o.given("force")) {
             const std::vector<std::string> variables = {"l", "ldot", "t"};
             const std::string law =
                 o.formula("force",
                           {"Additional force F [N]: a number or an expression in the variables l (m), ldot "
                            "(m/s) and t (s). Without it F is zero.",
                            R"("-5*ldot^3")"},
                           {}, variables);
             try {
                 spring.set_law(io::Expression(law, variables));
             } catch (const io::ExpressionError& e) {
                 o.fail("force", e.what());
             }
         }
         return std::make_unique<SpringDamper>(std::move(spring));
     }});

}  // namespace

}  // namespace hilda::dae
