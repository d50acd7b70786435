// SPDX-License-Identifier: GPL-3.0-or-later
#include "reference/motions/ball_on_sphere.hpp"

#include "lie/check.hpp"
#include "reference/solvers/event.hpp"

#include <cmath>
#include <functional>

namespace hilda::reference {

namespace {

enum Unknown { theta, v, omega, chi, unknowns };  // ω about -x, χ the angle turned about -x

double path_radius(const BallOnSphere& ball) { return ball.R + ball.r; }
double k(const BallOnSphere& ball) { return ball.J / (ball.m * ball.r * ball.r); }

double F_N(const BallOnSphere& ball, const ConstVectorRef& y)
{
    return ball.m * (ball.g * std::cos(y[theta]) - y[v] * y[v] / path_radius(ball));
}

using FrictionForce = std::function<double(const ConstVectorRef& y)>;

/// Friction force of rolling: k/(1 + k) m g sin θ with k = J/(m r²)
FrictionForce rolling(const BallOnSphere& ball)
{
    return [&ball](const ConstVectorRef& y) {
        return k(ball) / (1 + k(ball)) * ball.m * ball.g * std::sin(y[theta]);
    };
}

class Descent {
public:
    Descent(const BallOnSphere& ball, FrictionForce friction, double omega_0, const OdeTolerance& tolerance)
        : ball(ball), F_t(std::move(friction)), ode(
                                                    unknowns,
                                                    [this](double, const ConstVectorRef& x, VectorRef xdot) {
                                                        const BallOnSphere& b = this->ball;
                                                        xdot[theta] = x[v] / path_radius(b);
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
                        "v_0 must be positive; the top of the sphere is an equilibrium", ball.v_0);
        y[v] = ball.v_0;
        y[omega] = omega_0;
    }

    /// The ball rolls while F_t ≤ μ F_N and slips afterwards.
    void set_friction_limit(double friction) { mu = friction, sticking = true; }

    DescentResult at(const std::vector<double>& instants)
    {
        DescentResult run;
        in_flight = !(F_N(ball, y) > 0);
        if (in_flight) run.body = motion();
        double before = 0;
        for (const double instant : instants) {
            if (!(instant >= before))
                lie::reject("reference::BallOnSphere", "the instants must ascend and must not be negative",
                            instant);
            before = instant;
            advance(instant, run);
            run.instant.push_back(in_flight ? flight(run, instant) : contact());
        }
        while (!in_flight) advance(t + std::sqrt(path_radius(ball) / ball.g), run);
        return run;
    }

private:
    /// Integrates to t_end or to the lift-off
    void advance(double t_end, DescentResult& run)
    {
        while (!in_flight && t < t_end) {
            // During slip a larger v reduces F_N and with it the friction. The solution grows at the rate 2 μ
            // v/(R + r). A step much longer than the inverse of this rate overflows.
            const double search_interval = 0.1 / (10 * std::sqrt(ball.g / path_radius(ball)) +
                                                  2 * (sticking ? 0 : mu) * y[v] / path_radius(ball));
            const Event lift_off = [this](double, const ConstVectorRef& x) { return F_N(ball, x); };
            const Event slip_onset = [this](double, const ConstVectorRef& x) {
                return mu * F_N(ball, x) - F_t(x);
            };
            if (!advance_to_event(ode, t, y, t_end, search_interval, sticking ? slip_onset : lift_off))
                return;
            if (sticking) {
                F_t = [this](const ConstVectorRef& x) { return mu * F_N(ball, x); };
                run.t_slip = t;
                sticking = false;
            } else {
                in_flight = true;
                run.t = t;
                run.body = motion();
            }
        }
    }

    Vec3 n() const { return {0, std::sin(y[theta]), std::cos(y[theta])}; }

    Motion motion() const
    {
        Motion body;
        body.r = path_radius(ball) * n();
        body.rdot = y[v] * Vec3(0, n().z(), -n().y());
        body.rddot = Vec3(0, 0, -ball.g);  // acceleration in flight
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

    ContactInstant flight(const DescentResult& run, double instant) const
    {
        const double elapsed = instant - run.t;
        ContactInstant x;
        x.t = instant;
        x.body = run.body;
        x.body.r += elapsed * run.body.rdot + 0.5 * elapsed * elapsed * run.body.rddot;
        x.body.rdot += elapsed * run.body.rddot;
        x.body.A = run.body.A * lie::exp(elapsed * run.body.omega_bar);
        x.n = x.body.r.normalized();
        x.p = ball.R * x.n;
        x.a_bar = -ball.r * (x.body.A.transpose() * x.n);
        return x;
    }

    const BallOnSphere& ball;
    FrictionForce F_t;
    Ode ode;
    Eigen::VectorXd y;
    double t = 0, mu = 0;
    bool sticking = false, in_flight = false;
};

/// Time to the angle θ with this cosine, from v² = v_0² + 2 g (R + r) (1 - cos θ)/(1 + k)
double time_to_angle(const BallOnSphere& ball, double cosine, double k)
{
    if (!(cosine < 1)) return 0;
    Ode ode(1, [&](double angle, const ConstVectorRef&, VectorRef dt) {
        const double half = std::sin(angle / 2), fall = 2 * path_radius(ball) * half * half;
        dt[0] = path_radius(ball) / std::sqrt(ball.v_0 * ball.v_0 + 2 * ball.g * fall / (1 + k));
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

double BallOnSphere::slide_time() const { return time_to_angle(*this, slide_cosine(), 0); }
double BallOnSphere::roll_time() const { return time_to_angle(*this, roll_cosine(), k(*this)); }

DescentResult BallOnSphere::slide(const std::vector<double>& instants, const OdeTolerance& tolerance) const
{
    return Descent(
               *this, [](const ConstVectorRef&) { return 0.0; }, 0, tolerance)
        .at(instants);
}

DescentResult BallOnSphere::roll(const std::vector<double>& instants, const OdeTolerance& tolerance) const
{
    return Descent(*this, rolling(*this), v_0 / r, tolerance).at(instants);
}

DescentResult BallOnSphere::stick_slip(double mu, const std::vector<double>& instants,
                                       const OdeTolerance& tolerance) const
{
    if (!(mu > 0))
        lie::reject("reference::BallOnSphere",
                    "the coefficient of friction must be positive; use slide() without friction", mu);
    Descent descent(*this, rolling(*this), v_0 / r, tolerance);
    descent.set_friction_limit(mu);
    return descent.at(instants);
}

}  // namespace hilda::reference
