// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/motions/planar_bowl.hpp"

#include "lie/check.hpp"
#include "reference/motions/swing_period.hpp"
#include "reference/solvers/event.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace hilda::reference {

namespace {

enum Unknown { phi, v, omega, chi, S, unknowns };  // ω about x, χ the angle turned about x

/// The trough where the contact is
struct Place {
    double D, kappa;
    Vec3 p, t, n;

    Place(const PlanarBowl& bowl, double phi)
    {
        const double sine = std::sin(phi), cosine = std::cos(phi);
        D = std::hypot(bowl.c * sine, bowl.b * cosine);
        kappa = bowl.b * bowl.c / (D * D * D);
        p = Vec3(0, bowl.b * sine, -bowl.c * cosine);
        t = Vec3(0, bowl.b * cosine, bowl.c * sine) / D;
        n = Vec3(0, -bowl.c * sine, bowl.b * cosine) / D;
    }
};

/// What acts at the contact: along t, and about x
struct Action {
    double F_t = 0, T = 0;
};

/// That of rolling under the moment T: (m + J/R²) v̇ = m g·t - T/R and F_t = m v̇ - m g·t
Action rolling(const PlanarBowl& bowl, const Place& here, double T)
{
    const double k = bowl.J / (bowl.m * bowl.R * bowl.R);
    return {-(k * bowl.m * bowl.gravity().dot(here.t) + T / bowl.R) / (1 + k), T};
}

struct PlanarMotion {
    using Law = std::function<Action(const Place& here, const ConstVectorRef& y, double F_N)>;

    /// The ball starts with ω_x = -omega_by_v v.
    PlanarMotion(const PlanarBowl& bowl, const PlanarBowl::InitialState& start, double omega_by_v, Law law,
                 const OdeTolerance& tolerance)
        : bowl(bowl), law(std::move(law)),
          ode(
              unknowns, [this](double, const ConstVectorRef& x, VectorRef xdot) { rates(x, xdot); },
              tolerance),
          y(Eigen::VectorXd::Zero(unknowns))
    {
        for (const double positive : {bowl.b, bowl.c, bowl.R, bowl.m, bowl.J})
            if (!(positive > 0))
                lie::reject("reference::PlanarBowl", "lengths, mass and inertia must be positive", positive);
        const double smallest = std::min(bowl.b * bowl.b / bowl.c, bowl.c * bowl.c / bowl.b);
        if (!(bowl.R < smallest))
            lie::reject("reference::PlanarBowl",
                        "the ball must be smaller than the smallest radius of curvature, " +
                            std::to_string(smallest) + " m",
                        bowl.R);
        if (!(std::abs(start.y) < bowl.b))
            lie::reject("reference::PlanarBowl", "the contact point must be below the equator", start.y);
        y[phi] = std::asin(start.y / bowl.b);
        y[v] = start.v;
        y[omega] = -omega_by_v * start.v;
    }

    double psidot(const Place& here, double v) const { return here.kappa / (1 - bowl.R * here.kappa) * v; }
    double F_N(const Place& here, double v) const
    {
        return bowl.m * (v * psidot(here, v) - bowl.gravity().dot(here.n));
    }

    ContactInstant instant(double t) const
    {
        const Place here(bowl, y[phi]);
        const double N = F_N(here, y[v]);
        const Action action = law(here, y, N);
        ContactInstant x;
        x.t = t;
        x.p = here.p, x.n = here.n, x.F_N = N;
        x.F_t = action.F_t * here.t;
        x.moment = action.T * Vec3::UnitX();
        x.body.r = here.p + bowl.R * here.n;
        x.body.rdot = y[v] * here.t;
        x.body.rddot = bowl.gravity() + x.F() / bowl.m;
        x.body.A = lie::exp(y[chi] * Vec3::UnitX());
        x.body.omega_bar = y[omega] * Vec3::UnitX();
        x.body.omegadot_bar = (bowl.R * action.F_t + action.T) / bowl.J * Vec3::UnitX();
        x.a_bar = x.body.A.transpose() * (-bowl.R * here.n);
        return x;
    }

    std::vector<ContactInstant> at(const std::vector<double>& instants)
    {
        std::vector<ContactInstant> run;
        double t = 0;
        for (const double instant_k : instants) {
            ode.advance(t, y, instant_k);
            run.push_back(instant(t));
        }
        return run;
    }

    void rates(const ConstVectorRef& x, VectorRef& xdot) const
    {
        const Place here(bowl, x[phi]);
        const Action action = law(here, x, F_N(here, x[v]));
        xdot[phi] = x[v] / (here.D * (1 - bowl.R * here.kappa));
        xdot[v] = bowl.gravity().dot(here.t) + action.F_t / bowl.m;
        xdot[omega] = (bowl.R * action.F_t + action.T) / bowl.J;
        xdot[chi] = x[omega];
        xdot[S] = x[v] + bowl.R * x[omega];
    }

    const PlanarBowl& bowl;
    Law law;
    Ode ode;
    Eigen::VectorXd y;
};

/// T/F_N that friction of the coefficient μ gives
double resistance(const PlanarBowl& bowl, double eta, double mu, const Place& here)
{
    return 2 * eta * mu / (1 / bowl.R - here.kappa);
}

/// Two turns are never nearer than a good part of the fastest swing [s].
double look(const PlanarBowl& bowl) { return 0.05 * std::sqrt(std::min(bowl.b, bowl.c) / bowl.g); }

/// With r_z = -c cos φ + R b/√X, X = b² + c² tan²φ
double period(const PlanarBowl& bowl, double y, double mass)
{
    if (!(std::abs(y) < bowl.b && y != 0))
        lie::reject("reference::PlanarBowl", "a swing starts below the equator, beside the bottom", y);
    const double phi_0 = std::asin(std::abs(y) / bowl.b);
    const auto X = [&](double phi) {
        return bowl.b * bowl.b + bowl.c * bowl.c * std::tan(phi) * std::tan(phi);
    };
    return swing_period(
        phi_0,
        [&](double phi) {
            const Place here(bowl, phi);
            const double path = here.D * (1 - bowl.R * here.kappa);
            return mass * path * path;
        },
        [&](double phi, double to_go) {
            const double cosines = std::cos(phi) * std::cos(phi_0), root = std::sqrt(X(phi)),
                         root_0 = std::sqrt(X(phi_0));
            const double tan_squared = std::sin(to_go) * std::sin(phi_0 + phi) / (cosines * cosines);
            const double of_p = 2 * bowl.c * std::sin(to_go / 2) * std::sin((phi_0 + phi) / 2);
            const double of_n = bowl.b * bowl.c * bowl.c * tan_squared / (root * root_0 * (root + root_0));
            return bowl.m * bowl.g * (of_p - bowl.R * of_n);
        });
}

}  // namespace

std::vector<ContactInstant> PlanarBowl::slide(const InitialState& start, const std::vector<double>& instants,
                                              const OdeTolerance& tolerance) const
{
    const auto nothing = [](const Place&, const ConstVectorRef&, double) { return Action{}; };
    return PlanarMotion(*this, start, 0, nothing, tolerance).at(instants);
}

std::vector<ContactInstant> PlanarBowl::roll(const InitialState& start, const std::vector<double>& instants,
                                             const OdeTolerance& tolerance) const
{
    const auto stick = [this](const Place& here, const ConstVectorRef&, double) {
        return rolling(*this, here, 0);
    };
    return PlanarMotion(*this, start, 1 / R, stick, tolerance).at(instants);
}

std::vector<ContactInstant> PlanarBowl::spring(const InitialState& start, const TangentialSpring& law,
                                               const std::vector<double>& instants,
                                               const OdeTolerance& tolerance) const
{
    const auto force = [this, &law](const Place&, const ConstVectorRef& y, double) {
        return Action{-law.K_E * y[S] - law.K_D * (y[v] + R * y[omega]), 0};
    };
    return PlanarMotion(*this, start, 1 / R, force, tolerance).at(instants);
}

ResistedRoll PlanarBowl::resist(const InitialState& start, const RollingResistance& law,
                                const std::vector<double>& instants, const OdeTolerance& tolerance) const
{
    if (!(law.eta >= 0 && law.mu_k >= 0 && law.mu_s >= law.mu_k))
        lie::reject("reference::PlanarBowl", "eta and mu_k must not be negative, nor mu_s below mu_k",
                    law.mu_s);

    double way = 0;  // the sign of v; zero at rest, where T holds the ball
    const auto force = [&](const Place& here, const ConstVectorRef&, double F_N) {
        if (way == 0) return Action{-m * gravity().dot(here.t), R * m * gravity().dot(here.t)};
        return rolling(*this, here, way * resistance(*this, law.eta, law.mu_k, here) * F_N);
    };
    PlanarMotion motion(*this, start, 1 / R, force, tolerance);
    const auto released = [&] {  // the way it goes from v = 0
        const Place here(*this, motion.y[phi]);
        const double weight = m * gravity().dot(here.t);
        const double hold = resistance(*this, law.eta, law.mu_s, here) * motion.F_N(here, 0);
        if (R * std::abs(weight) <= hold) return 0.0;
        return weight > 0 ? 1.0 : -1.0;
    };
    way = start.v == 0 ? released() : start.v > 0 ? 1.0 : -1.0;

    ResistedRoll run;
    double t = 0;
    if (way == 0) run.turn.push_back({0, start.y, true});
    for (const double instant : instants) {
        if (instant < t) lie::reject("reference::PlanarBowl", "the instants must ascend from zero", instant);
        while (t < instant && way != 0) {
            const auto onward = [&](double, const ConstVectorRef& y) { return way * y[v]; };
            if (!advance_to_event(motion.ode, t, motion.y, instant, look(*this), onward)) continue;
            motion.y[v] = motion.y[omega] = 0;
            way = released();
            run.turn.push_back({t, b * std::sin(motion.y[phi]), way == 0});
        }
        if (way == 0) t = instant;
        run.instant.push_back(motion.instant(t));
    }
    return run;
}

double PlanarBowl::slide_period(double y) const { return period(*this, y, m); }
double PlanarBowl::roll_period(double y) const { return period(*this, y, m + J / (R * R)); }

}  // namespace hilda::reference
