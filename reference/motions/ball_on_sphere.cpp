// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/motions/ball_on_sphere.hpp"

#include "lie/check.hpp"
#include "reference/solvers/event.hpp"

#include <cmath>
#include <functional>

namespace hilda::reference {

namespace {

enum Unknown { theta, v, omega, chi, unknowns };  // ω about -x, χ the angle turned about -x

double path(const BallOnSphere& ball) { return ball.R + ball.r; }
double k(const BallOnSphere& ball) { return ball.J / (ball.m * ball.r * ball.r); }

double F_N(const BallOnSphere& ball, const ConstVectorRef& y)
{
    return ball.m * (ball.g * std::cos(y[theta]) - y[v] * y[v] / path(ball));
}

using Friction = std::function<double(const ConstVectorRef& y)>;

/// J/(m r²) of the weight is what friction takes from a ball that rolls.
Friction rolling(const BallOnSphere& ball)
{
    return [&ball](const ConstVectorRef& y) {
        return k(ball) / (1 + k(ball)) * ball.m * ball.g * std::sin(y[theta]);
    };
}

class Descent {
public:
    Descent(const BallOnSphere& ball, Friction friction, double omega_0, const OdeTolerance& tolerance)
        : ball(ball), F_t(std::move(friction)), ode(
                                                    unknowns,
                                                    [this](double, const ConstVectorRef& x, VectorRef xdot) {
                                                        const BallOnSphere& b = this->ball;
                                                        xdot[theta] = x[v] / path(b);
                                                        xdot[v] = b.g * std::sin(x[theta]) - F_t(x) / b.m;
                                                        xdot[omega] = b.r * F_t(x) / b.J;
                                                        xdot[chi] = x[omega];
                                                    },
                                                    tolerance),
          y(Eigen::VectorXd::Zero(unknowns))
    {
        for (const double positive : {ball.R, ball.r, ball.m, ball.J, ball.g})
            if (!(positive > 0))
                lie::reject("reference::BallOnSphere", "lengths, mass, inertia and gravity must be positive",
                            positive);
        if (!(ball.v_0 > 0))
            lie::reject("reference::BallOnSphere",
                        "the ball leaves the top only with a velocity: v_0 must be positive", ball.v_0);
        y[v] = ball.v_0;
        y[omega] = omega_0;
    }

    /// Rolls on only while F_t ≤ μ F_N
    void slips_beyond(double friction) { mu = friction, sticks = true; }

    Departure at(const std::vector<double>& instants)
    {
        Departure run;
        flies = !(F_N(ball, y) > 0);
        if (flies) run.body = motion();
        double before = 0;
        for (const double instant : instants) {
            if (!(instant >= before))
                lie::reject("reference::BallOnSphere", "the instants must ascend from zero", instant);
            before = instant;
            go(instant, run);
            run.instant.push_back(flies ? flight(run, instant) : contact());
        }
        while (!flies) go(t + std::sqrt(path(ball) / ball.g), run);
        return run;
    }

private:
    /// To t_end, or to where it leaves
    void go(double t_end, Departure& run)
    {
        while (!flies && t < t_end) {
            // A ball that slips presses less as it gets faster, and is braked less: this grows at 2 μ v/(R + r),
            // and a step far beyond that is not finite.
            const double look =
                0.1 / (10 * std::sqrt(ball.g / path(ball)) + 2 * (sticks ? 0 : mu) * y[v] / path(ball));
            const Event leaves = [this](double, const ConstVectorRef& x) { return F_N(ball, x); };
            const Event slips = [this](double, const ConstVectorRef& x) {
                return mu * F_N(ball, x) - F_t(x);
            };
            if (!advance_to_event(ode, t, y, t_end, look, sticks ? slips : leaves)) return;
            if (sticks) {
                F_t = [this](const ConstVectorRef& x) { return mu * F_N(ball, x); };
                run.t_slip = t;
                sticks = false;
            } else {
                flies = true;
                run.t = t;
                run.body = motion();
            }
        }
    }

    Vec3 n() const { return {0, std::sin(y[theta]), std::cos(y[theta])}; }

    Motion motion() const
    {
        Motion body;
        body.r = path(ball) * n();
        body.rdot = y[v] * Vec3(0, n().z(), -n().y());
        body.rddot = Vec3(0, 0, -ball.g);  // of flight
        body.A = lie::exp(-y[chi] * Vec3::UnitX());
        body.omega_bar = -y[omega] * Vec3::UnitX();
        return body;
    }

    ContactInstant contact() const
    {
        ContactInstant x;
        x.t = t;
        x.n = n();
        x.p = ball.R * x.n;
        x.F_N = F_N(ball, y);
        x.F_t = -F_t(y) * Vec3(0, x.n.z(), -x.n.y());
        x.body = motion();
        x.body.rddot += x.F() / ball.m;
        x.body.omegadot_bar = -ball.r * F_t(y) / ball.J * Vec3::UnitX();
        x.a_bar = -ball.r * (x.body.A.transpose() * x.n);
        return x;
    }

    ContactInstant flight(const Departure& run, double instant) const
    {
        const double since = instant - run.t;
        ContactInstant x;
        x.t = instant;
        x.body = run.body;
        x.body.r += since * run.body.rdot + 0.5 * since * since * run.body.rddot;
        x.body.rdot += since * run.body.rddot;
        x.body.A = run.body.A * lie::exp(since * run.body.omega_bar);
        x.n = x.body.r.normalized();
        x.p = ball.R * x.n;
        x.a_bar = -ball.r * (x.body.A.transpose() * x.n);
        return x;
    }

    const BallOnSphere& ball;
    Friction F_t;
    Ode ode;
    Eigen::VectorXd y;
    double t = 0, mu = 0;
    bool sticks = false, flies = false;
};

/// v² = v_0² + 2 g (R + r) (1 - cos θ)/(1 + k): t up to the angle of this cosine
double time_to(const BallOnSphere& ball, double cosine, double k)
{
    if (!(cosine < 1)) return 0;
    Ode ode(1, [&](double angle, const ConstVectorRef&, VectorRef dt) {
        const double half = std::sin(angle / 2), fall = 2 * path(ball) * half * half;
        dt[0] = path(ball) / std::sqrt(ball.v_0 * ball.v_0 + 2 * ball.g * fall / (1 + k));
    });
    Eigen::VectorXd t = Eigen::VectorXd::Zero(1);
    double angle = 0;
    ode.advance(angle, t, std::acos(cosine));
    return t[0];
}

}  // namespace

double BallOnSphere::slide_cosine() const { return (2 + v_0 * v_0 / (g * (R + r))) / 3; }

double BallOnSphere::roll_cosine() const
{
    return (2 + (1 + k(*this)) * v_0 * v_0 / (g * (R + r))) / (3 + k(*this));
}

double BallOnSphere::slide_time() const { return time_to(*this, slide_cosine(), 0); }
double BallOnSphere::roll_time() const { return time_to(*this, roll_cosine(), k(*this)); }

Departure BallOnSphere::slide(const std::vector<double>& instants, const OdeTolerance& tolerance) const
{
    return Descent(
               *this, [](const ConstVectorRef&) { return 0.0; }, 0, tolerance)
        .at(instants);
}

Departure BallOnSphere::roll(const std::vector<double>& instants, const OdeTolerance& tolerance) const
{
    return Descent(*this, rolling(*this), v_0 / r, tolerance).at(instants);
}

Departure BallOnSphere::stick_slip(double mu, const std::vector<double>& instants,
                                   const OdeTolerance& tolerance) const
{
    if (!(mu > 0))
        lie::reject("reference::BallOnSphere", "friction must be positive, or the ball slides", mu);
    Descent descent(*this, rolling(*this), v_0 / r, tolerance);
    descent.slips_beyond(mu);
    return descent.at(instants);
}

}  // namespace hilda::reference
