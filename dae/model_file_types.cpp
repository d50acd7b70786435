// SPDX-License-Identifier: GPL-3.0-or-later
/// Readers of the constraint and force types, and the registered reader of contacts.
#include "dae/model_file_types.hpp"

#include "dae/constraints/cd.hpp"
#include "dae/constraints/d.hpp"
#include "dae/constraints/dp1.hpp"
#include "dae/constraints/dp2.hpp"
#include "dae/forces/spring_damper.hpp"
#include "dae/forces/torsion_spring.hpp"
#include "dae/joints.hpp"
#include "io/expression.hpp"
#include "io/jet.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace hilda::dae {

namespace {

/// The driver given by a key. f, ḟ and f̈ must be finite at t = 0.
Driver driver(ObjectReader& o, std::string_view key, const std::optional<std::string>& fallback = {})
{
    const std::string text = o.formula(key, fallback);
    try {
        Driver f(text);
        const io::Jet start = f.jet(0);
        if (!std::isfinite(f.f(0)) || !std::isfinite(start.fdot) || !std::isfinite(start.fddot))
            o.fail(key, std::string(key) + " and its derivatives must be finite at t = 0, got " +
                            described(text) + " with the value " + shortest(f.f(0)) +
                            " and the derivatives " + shortest(start.fdot) + ", " + shortest(start.fddot));
        return f;
    } catch (const io::ExpressionError& e) {
        o.fail(key, e.what());
    }
}

/// f(t) of a basic constraint, by default 0
Driver f(ObjectReader& o) { return driver(o, "f", "0"); }

/// Points P and Q of the two bodies in the body frames [m], by default the centres of mass
struct Points {
    Vec3 i, j;
    explicit Points(ObjectReader& o)
        : i(o.vec3("s_bar_p_i", Vec3::Zero())), j(o.vec3("s_bar_q_j", Vec3::Zero()))
    {}
};

/// Axes of the two bodies in the body frames, not zero
struct Axes {
    Vec3 i, j;
    explicit Axes(ObjectReader& o) : i(o.direction("axis_bar_i")), j(o.direction("axis_bar_j")) {}
};

template <class B>
Blocks single_row(B block)
{
    Blocks rows;
    rows.push_back(std::make_unique<B>(std::move(block)));
    return rows;
}

template <class Reader>
struct Type {
    std::string_view name;
    Reader read;
};

// Elements of a braced list are evaluated in order. This is the order of the keys in the canonical form.
using ReadConstraint = Blocks (*)(ObjectReader& o, int i, int j, const State& x);
constexpr Type<ReadConstraint> constraints[] = {
    {"DP1",
     [](ObjectReader& o, int i, int j, const State&) {
         return single_row(DP1{i, o.direction("a_bar_i"), j, o.direction("a_bar_j"), f(o)});
     }},
    {"DP2",
     [](ObjectReader& o, int i, int j, const State&) {
         const Vec3 a_bar_i = o.direction("a_bar_i");
         const Points s(o);
         return single_row(DP2(i, a_bar_i, s.i, j, s.j, f(o)));
     }},
    {"D",
     [](ObjectReader& o, int i, int j, const State&) {
         const Points s(o);
         return single_row(D(i, s.i, j, s.j, driver(o, "f")));
     }},
    {"CD",
     [](ObjectReader& o, int i, int j, const State&) {
         const Vec3 c = o.direction("c");
         const Points s(o);
         return single_row(CD(c, i, s.i, j, s.j, f(o)));
     }},
    {"spherical",
     [](ObjectReader& o, int i, int j, const State&) {
         const Points s(o);
         return spherical(i, s.i, j, s.j);
     }},
    {"revolute",
     [](ObjectReader& o, int i, int j, const State&) {
         const Points s(o);
         const Axes axis(o);
         return revolute(i, s.i, axis.i, j, s.j, axis.j);
     }},
    {"cylindrical",
     [](ObjectReader& o, int i, int j, const State&) {
         const Points s(o);
         const Axes axis(o);
         return cylindrical(i, s.i, axis.i, j, s.j, axis.j);
     }},
    {"translational",
     [](ObjectReader& o, int i, int j, const State& x) {
         const Points s(o);
         const Axes axis(o);
         return translational(i, s.i, axis.i, j, s.j, axis.j, x);
     }},
    {"universal",
     [](ObjectReader& o, int i, int j, const State&) {
         const Points s(o);
         const Axes axis(o);
         return universal(i, s.i, axis.i, j, s.j, axis.j);
     }},
    {"revolute-cylindrical",
     [](ObjectReader& o, int i, int j, const State&) {
         const Points s(o);
         const Axes axis(o);
         return revolute_cylindrical(i, s.i, axis.i, j, s.j, axis.j);
     }},
    {"fixed", [](ObjectReader&, int i, int j, const State& x) { return fixed(i, j, x); }},
    {"distance",
     [](ObjectReader& o, int i, int j, const State&) {
         const Points s(o);
         return distance(i, s.i, j, s.j, o.positive("length"));
     }},
    {"hinge-driver",
     [](ObjectReader& o, int i, int j, const State& x) {
         const Axes axis(o);
         return hinge_driver(i, axis.i, j, axis.j, driver(o, "angle"), x);
     }},
};

using ReadPairForce = std::unique_ptr<Force> (*)(ObjectReader& o, int i, int j, const State& x);
constexpr Type<ReadPairForce> pair_forces[] = {
    {"spring-damper",
     [](ObjectReader& o, int i, int j, const State&) -> std::unique_ptr<Force> {
         const Points s(o);
         const double k = o.not_negative("stiffness"), c = o.not_negative("damping", 0);
         SpringDamper spring(i, s.i, j, s.j, k, c, o.not_negative("free_length"));
         if (o.find("force") != nullptr) {
             const std::string law = o.formula("force");
             try {
                 spring.law.emplace(law, std::vector<std::string>{"l", "ldot", "t"});
             } catch (const io::ExpressionError& e) {
                 o.fail("force", e.what());
             }
         }
         return std::make_unique<SpringDamper>(std::move(spring));
     }},
    {"torsion-spring",
     [](ObjectReader& o, int i, int j, const State& x) -> std::unique_ptr<Force> {
         const Axes axis(o);
         const double k = o.not_negative("stiffness"), c = o.not_negative("damping", 0);
         return std::make_unique<TorsionSpring>(i, axis.i, j, axis.j, k, c, o.number("free_angle"), x);
     }},
};

template <class Types>
std::vector<std::string> names(const Types& types)
{
    std::vector<std::string> all;
    for (const auto& type : types) all.emplace_back(type.name);
    return all;
}

template <class Types>
auto reader(const std::string& name, const Types& types)
{
    const auto found =
        std::find_if(std::begin(types), std::end(types), [&](const auto& type) { return type.name == name; });
    assert(found != std::end(types));
    return found->read;
}

}  // namespace

const std::vector<std::string>& constraint_types()
{
    static const std::vector<std::string> all = names(constraints);
    return all;
}

Blocks read_constraint(const std::string& type, ObjectReader& o, int i, int j, const State& x)
{
    return reader(type, constraints)(o, i, j, x);
}

const std::vector<std::string>& pair_force_types()
{
    static const std::vector<std::string> all = names(pair_forces);
    return all;
}

std::unique_ptr<Force> read_pair_force(const std::string& type, ObjectReader& o, int i, int j, const State& x)
{
    return reader(type, pair_forces)(o, i, j, x);
}

namespace {

// A function-local variable is initialised before its first use, also during static initialisation.
ReadContact& registered()
{
    static ReadContact read = nullptr;
    return read;
}

}  // namespace

bool register_contact_reader(ReadContact read)
{
    registered() = read;
    return true;
}

ReadContact contact_reader() { return registered(); }

}  // namespace hilda::dae
