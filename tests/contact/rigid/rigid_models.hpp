// SPDX-License-Identifier: GPL-3.0-or-later
/// Texts of models with rigid contacts, and their runs with rA-moreau-1.

#pragma once

#include "contact/rigid/rigid_contacts.hpp"
#include "dae/model_file.hpp"
#include "io/json.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/statistics.hpp"
#include "lie/trajectory.hpp"

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

namespace rigid_tests {

using hilda::lie::State;
using hilda::lie::Vec3;

constexpr double g = 9.81;
constexpr double degree = std::numbers::pi / 180;

inline std::string number(double x) { return hilda::io::shortest(x); }

inline std::string list(const Vec3& a)
{
    return '[' + number(a[0]) + ", " + number(a[1]) + ", " + number(a[2]) + ']';
}

inline std::string model(const std::string& bodies, const std::string& contacts,
                         const Vec3& gravity = Vec3(0, 0, -g), const std::string& constraints = "",
                         const std::string& more = "")
{
    return R"({"hilda_model": 1, "name": "m", "gravity": )" + list(gravity) + R"(, "bodies": [)" + bodies +
           R"(], "constraints": [)" + constraints + R"(], "contacts": [)" + contacts + "]" + more + "}";
}

/// `v`: velocity in the global frame, `omega`: angular velocity in the body frame, `more`: further members
inline std::string body(const std::string& name, double mass, const std::string& shape, const Vec3& r,
                        const Vec3& v = Vec3::Zero(), const Vec3& omega = Vec3::Zero(),
                        const std::string& more = "")
{
    return R"({"name": ")" + name + R"(", "mass": )" + number(mass) + R"(, "shape": )" + shape +
           R"(, "r": )" + list(r) + R"(, "r_dot": )" + list(v) + R"(, "omega": )" + list(omega) + more + '}';
}

/// Rotated about y, from z to x for a positive angle
inline std::string about_y(double angle) { return R"(, "axis_angle": [0, 1, 0, )" + number(angle) + ']'; }

inline std::string dvi(double mu, double e)
{
    return R"("normal": {"type": "dvi", "restitution": )" + number(e) +
           R"(}, "friction": {"law": "coulomb", "mu_s": )" + number(mu) + "}";
}

/// The contact of two bodies
inline std::string contact_of(const std::string& i, const std::string& j, const std::string& surface_i,
                              const std::string& surface_j, double mu, double e = 0)
{
    return R"({"name": ")" + i + '-' + j + R"(", "body_i": ")" + i + R"(", "body_j": ")" + j +
           R"(", "surface_i": )" + surface_i + R"(, "surface_j": )" + surface_j + ", " + dvi(mu, e) + '}';
}

/// The contact of a body with the plane z = 0
inline std::string on_floor(const std::string& name, const std::string& surface, double mu, double e = 0)
{
    return contact_of(name, "ground", surface, R"({"type": "plane"})", mu, e);
}

/// The elements of a JSON list
inline std::string joined(const std::vector<std::string>& elements)
{
    std::string all;
    for (const std::string& e : elements) all += (all.empty() ? "" : ", ") + e;
    return all;
}

inline std::string box_shape(const Vec3& lengths) { return R"({"box": )" + list(lengths) + '}'; }
inline std::string box_surface(const Vec3& lengths)
{
    return R"({"type": "box", "lengths": )" + list(lengths) + '}';
}
inline std::string ball_shape(double R) { return R"({"sphere": )" + number(R) + '}'; }
inline std::string ball_surface(double R) { return R"({"type": "sphere", "radius": )" + number(R) + '}'; }

/// A run with rA-moreau-1
class Run {
public:
    Run(const std::string& text, double h) : of(hilda::dae::read_model(text, "m.json")), h(h)
    {
        hilda::dae::start(of);
        integrator = hilda::lie::scheme("rA-moreau-1").make(*of.model, {});
        march = std::make_unique<hilda::lie::March>(of.x, *integrator, h);
    }

    const State& state() const { return march->node(); }
    const hilda::dae::Model& system() const { return *of.model; }
    const hilda::lie::Motion& body(int i) const { return state().body[static_cast<std::size_t>(i)]; }
    double angle_about_y(int i) const { return std::atan2(body(i).A(0, 2), body(i).A(2, 2)); }
    void step() { march->advance({}); }
    /// Steps until t and calls `visit` after each.
    void to(double t, const std::function<void(const State&)>& visit = {})
    {
        for (long n = std::lround((t - state().t) / h); n > 0; --n) {
            step();
            if (visit) visit(state());
        }
    }
    hilda::lie::Statistics statistics() const { return integrator->statistics(); }
    /// The contact points of one contact of the file, for a pair of bodies
    std::vector<hilda::contact::LoadedPoint> points(int contact, int pair = 0) const
    {
        std::vector<hilda::contact::LoadedPoint> found;
        const auto& all = of.model->rigid_contacts();
        dynamic_cast<const hilda::contact::RigidContacts&>(*all[static_cast<std::size_t>(contact)])
            .points(state(), pair, found);
        return found;
    }
    /// Kinetic and potential energy of gravity [J]
    double energy() const
    {
        const auto& mass = of.model->mass();
        double E = 0;
        for (std::size_t b = 0; b < state().body.size(); ++b) {
            const auto& x = state().body[b];
            E += 0.5 * mass.m[b] * x.rdot.squaredNorm() + 0.5 * x.omega_bar.dot(mass.J_bar[b] * x.omega_bar) -
                 mass.m[b] * of.model->gravity.dot(x.r);
        }
        return E;
    }

private:
    hilda::dae::Description of;
    const double h;
    std::unique_ptr<hilda::lie::Integrator> integrator;
    std::unique_ptr<hilda::lie::March> march;
};

/// Runs to t_end and calls `visit` after each step.
inline State run(const std::string& text, double h, double t_end,
                 const std::function<void(const State&)>& visit = {})
{
    Run r(text, h);
    r.to(t_end, visit);
    return r.state();
}

}  // namespace rigid_tests
