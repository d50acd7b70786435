// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/steps/step_control.hpp"

#include "lie/check.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::lie {

namespace {

constexpr double safety = 0.8, most_growth = 5, least_growth = 0.2, least_error = 1e-4;

double checked(const std::string& scheme, const char* name, double tolerance)
{
    if (!(tolerance >= 1e-14 && tolerance <= 0.1))
        reject("integrator " + scheme, std::string(name) + " must be from 1e-14 to 0.1", tolerance);
    return tolerance;
}

}  // namespace

Tolerances::Tolerances(const Settings& settings, const std::string& scheme)
    : rtol(checked(scheme, "rtol", settings.rtol)),
      atol(settings.atol > 0 ? checked(scheme, "atol", settings.atol) : rtol)
{}

void StepControl::accept(double step, double error, int q)
{
    const double beta = 0.2 / q, alpha = 1. / q - 0.75 * beta;
    const double factor = safety * std::pow(std::max(error, 1e-12), -alpha) * std::pow(last_error, beta);
    h = step * std::clamp(factor, least_growth, most_growth);
    last_error = std::max(error, least_error);
}

void StepControl::reject(double step, double error, int q)
{
    const double factor = safety * std::pow(error, -1. / q);
    h = step * (std::isfinite(error) ? std::clamp(factor, least_growth, safety) : least_growth);
}

void set_tolerances(const State& from, const State& to, double rtol, double atol, Eigen::VectorXd& out)
{
    for (size_t i = 0; i < from.body.size(); ++i) {
        const Motion &a = from.body[i], &b = to.body[i];
        const auto of = [&](const Vec3& x, const Vec3& y) {
            return atol + rtol * std::sqrt(std::max(x.squaredNorm(), y.squaredNorm()));
        };
        auto body = out.segment<12>(static_cast<Eigen::Index>(12 * i));
        body.head<3>().setConstant(of(a.r, b.r));
        body.segment<3>(3).setConstant(atol + rtol);
        body.segment<3>(6).setConstant(of(a.rdot, b.rdot));
        body.tail<3>().setConstant(of(a.omega_bar, b.omega_bar));
    }
}

double rms_over(const Eigen::VectorXd& tolerance, const Eigen::VectorXd& error)
{
    return std::sqrt(error.cwiseQuotient(tolerance).squaredNorm() / static_cast<double>(error.size()));
}

double FirstStep::euler() const
{
    constexpr double negligible = 1e-10, smallest = 1e-6;  // [s]
    return size < negligible || rate < negligible ? smallest : 0.01 * size / rate;
}

double FirstStep::of_order(int q, double rate_of_rate) const
{
    const double fastest = std::max(rate, rate_of_rate);
    const double h = fastest <= 1e-15 ? std::max(1e-6, 1e-3 * euler()) : std::pow(0.01 / fastest, 1. / q);
    return std::min(100 * euler(), h);
}

}  // namespace hilda::lie
