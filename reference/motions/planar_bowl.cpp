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

/// Geometry of the trough at the contact point: D, κ, p, t, n
struct TroughPoint {
    double D, kappa;
    Vec3 p, t, n;

    TroughPoint(const PlanarBowl& bowl, double phi)
    {
        const double sine = std::sin(phi), cosine = std::cos(phi);
        D = std::hypot(bowl.c * sine, bowl.b * cosine);
        kappa = bowl.b * bowl.c / (D * D * D);
        p = Vec3(0, bowl.b * sine, -bowl.c * cosine);
        t = Vec3(0, bowl.b * cosine, bowl.c * sine) / D;
        n = Vec3(0, -bowl.c * sine, bowl.b * cosine) / D;
    }
};

/// Friction force along t [N] and moment about x [N m] on the ball
struct ContactLoad {
    double F_t = 0, T = 0;
};

/// Load of rolling without slip under the moment T: (m + J/R²) v̇ = m g·t - T/R and F_t = m v̇ - m g·t
ContactLoad rolling(const PlanarBowl& bowl, const TroughPoint& point, double T)
{
    const double k = bowl.J / (bowl.m * bowl.R * bowl.R);
    return {-(k * bowl.m * bowl.gravity().dot(point.t) + T / bowl.R) / (1 + k), T};
}

struct PlanarMotion {
    using LoadLaw = std::function<ContactLoad(const TroughPoint& point, const ConstVectorRef& y, double F_N)>;

    /// The ball starts with ω_x = -omega_by_v v.
    PlanarMotion(const PlanarBowl& bowl, const PlanarBowl::InitialState& start, double omega_by_v,
                 LoadLaw law, const OdeTolerance& tolerance)
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
            lie::reject("reference::PlanarBowl",
                        "the contact point must be on the lower half of the trough: |y| < b", start.y);
        y[phi] = std::asin(start.y / bowl.b);
        y[v] = start.v;
        y[omega] = -omega_by_v * start.v;
    }

    double psidot(const TroughPoint& point, double v) const
    {
        return point.kappa / (1 - bowl.R * point.kappa) * v;
    }
    double F_N(const TroughPoint& point, double v) const
    {
        return bowl.m * (v * psidot(point, v) - bowl.gravity().dot(point.n));
    }

    ContactInstant instant(double t) const
    {
        const TroughPoint point(bowl, y[phi]);
        const double N = F_N(point, y[v]);
        const ContactLoad action = law(point, y, N);
        ContactInstant x;
        x.t = t;
        x.p = point.p, x.n = point.n, x.F_N = N;
        x.F_t = action.F_t * point.t;
        x.moment = action.T * Vec3::UnitX();
        x.body.r = point.p + bowl.R * point.n;
        x.body.rdot = y[v] * point.t;
        x.body.rddot = bowl.gravity() + x.F() / bowl.m;
        x.body.A = lie::exp(y[chi] * Vec3::UnitX());
        x.body.omega_bar = y[omega] * Vec3::UnitX();
        x.body.omegadot_bar = (bowl.R * action.F_t + action.T) / bowl.J * Vec3::UnitX();
        x.a_bar = x.body.A.transpose() * (-bowl.R * point.n);
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
        const TroughPoint point(bowl, x[phi]);
        const ContactLoad action = law(point, x, F_N(point, x[v]));
        xdot[phi] = x[v] / (point.D * (1 - bowl.R * point.kappa));
        xdot[v] = bowl.gravity().dot(point.t) + action.F_t / bowl.m;
        xdot[omega] = (bowl.R * action.F_t + action.T) / bowl.J;
        xdot[chi] = x[omega];
        xdot[S] = x[v] + bowl.R * x[omega];
    }

    const PlanarBowl& bowl;
    LoadLaw law;
    Ode ode;
    Eigen::VectorXd y;
};

/// |T|/F_N of rolling resistance with the coefficient μ [m]
double resistance(const PlanarBowl& bowl, double eta, double mu, const TroughPoint& point)
{
    return 2 * eta * mu / (1 / bowl.R - point.kappa);
}

/// Interval of the event search [s], a small fraction of the shortest period. Reversals are farther apart.
double search_interval(const PlanarBowl& bowl) { return 0.05 * std::sqrt(std::min(bowl.b, bowl.c) / bowl.g); }

/// Period from the energy integral with r_z = -c cos φ + R b/√X, X = b² + c² tan²φ
double period(const PlanarBowl& bowl, double y, double mass)
{
    if (!(std::abs(y) < bowl.b && y != 0))
        lie::reject("reference::PlanarBowl", "an oscillation must start at 0 < |y| < b", y);
    const double phi_0 = std::asin(std::abs(y) / bowl.b);
    const auto X = [&](double phi) {
        return bowl.b * bowl.b + bowl.c * bowl.c * std::tan(phi) * std::tan(phi);
    };
    return swing_period(
        phi_0,
        [&](double phi) {
            const TroughPoint point(bowl, phi);
            const double path = point.D * (1 - bowl.R * point.kappa);
            return mass * path * path;
        },
        [&](double phi, double remaining) {
            const double cosines = std::cos(phi) * std::cos(phi_0), root = std::sqrt(X(phi)),
                         root_0 = std::sqrt(X(phi_0));
            const double tan_squared = std::sin(remaining) * std::sin(phi_0 + phi) / (cosines * cosines);
            const double drop_p = 2 * bowl.c * std::sin(remaining / 2) * std::sin((phi_0 + phi) / 2);
            const double drop_n = bowl.b * bowl.c * bowl.c * tan_squared / (root * root_0 * (root + root_0));
            return bowl.m * bowl.g * (drop_p - bowl.R * drop_n);
        });
}

}  // namespace

std::vector<ContactInstant> PlanarBowl::slide(const InitialState& start, const std::vector<double>& instants,
                                              const OdeTolerance& tolerance) const
{
    const auto no_load = [](const TroughPoint&, const ConstVectorRef&, double) { return ContactLoad{}; };
    return PlanarMotion(*this, start, 0, no_load, tolerance).at(instants);
}

std::vector<ContactInstant> PlanarBowl::roll(const InitialState& start, const std::vector<double>& instants,
                                             const OdeTolerance& tolerance) const
{
    const auto rolling_load = [this](const TroughPoint& point, const ConstVectorRef&, double) {
        return rolling(*this, point, 0);
    };
    return PlanarMotion(*this, start, 1 / R, rolling_load, tolerance).at(instants);
}

std::vector<ContactInstant> PlanarBowl::spring(const InitialState& start, const TangentialSpring& law,
                                               const std::vector<double>& instants,
                                               const OdeTolerance& tolerance) const
{
    const auto load = [this, &law](const TroughPoint&, const ConstVectorRef& y, double) {
        return ContactLoad{-law.K_E * y[S] - law.K_D * (y[v] + R * y[omega]), 0};
    };
    return PlanarMotion(*this, start, 1 / R, load, tolerance).at(instants);
}

ResistedRolling PlanarBowl::resist(const InitialState& start, const RollingResistance& law,
                                   const std::vector<double>& instants, const OdeTolerance& tolerance) const
{
    if (!(law.eta >= 0 && law.mu_k >= 0 && law.mu_s >= law.mu_k))
        lie::reject("reference::PlanarBowl",
                    "eta and mu_k must not be negative and mu_s must not be smaller than mu_k; mu_s",
                    law.mu_s);

    double direction = 0;  // sign of v; zero at rest, where T balances the weight
    const auto load = [&](const TroughPoint& point, const ConstVectorRef&, double F_N) {
        if (direction == 0) return ContactLoad{-m * gravity().dot(point.t), R * m * gravity().dot(point.t)};
        return rolling(*this, point, direction * resistance(*this, law.eta, law.mu_k, point) * F_N);
    };
    PlanarMotion motion(*this, start, 1 / R, load, tolerance);
    const auto direction_from_rest = [&] {  // sign of v after an instant with v = 0
        const TroughPoint point(*this, motion.y[phi]);
        const double weight = m * gravity().dot(point.t);
        const double limit = resistance(*this, law.eta, law.mu_s, point) * motion.F_N(point, 0);
        if (R * std::abs(weight) <= limit) return 0.0;
        return weight > 0 ? 1.0 : -1.0;
    };
    direction = start.v == 0 ? direction_from_rest() : start.v > 0 ? 1.0 : -1.0;

    ResistedRolling run;
    double t = 0;
    if (direction == 0) run.reversal.push_back({0, start.y, true});
    for (const double instant : instants) {
        if (instant < t)
            lie::reject("reference::PlanarBowl", "the instants must ascend and must not be negative",
                        instant);
        while (t < instant && direction != 0) {
            const auto speed = [&](double, const ConstVectorRef& y) { return direction * y[v]; };
            if (!advance_to_event(motion.ode, t, motion.y, instant, search_interval(*this), speed)) continue;
            motion.y[v] = motion.y[omega] = 0;
            direction = direction_from_rest();
            run.reversal.push_back({t, b * std::sin(motion.y[phi]), direction == 0});
        }
        if (direction == 0) t = instant;
        run.instant.push_back(motion.instant(t));
    }
    return run;
}

double PlanarBowl::slide_period(double y) const { return period(*this, y, m); }
double PlanarBowl::roll_period(double y) const { return period(*this, y, m + J / (R * R)); }

}  // namespace hilda::reference
