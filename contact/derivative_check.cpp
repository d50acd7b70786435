// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/derivative_check.hpp"

#include "contact/friction/friction.hpp"
#include "contact/normal/normal_law.hpp"
#include "contact/shape.hpp"
#include "dae/start/differences.hpp"
#include "io/message.hpp"
#include "lie/check.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace hilda::contact {

namespace {

using dae::RowValues;

constexpr double first_step = 2e-3;     // the largest of differences, relative to the size or the overlap
constexpr double of_surface = 1e-4;     // largest difference, relative to the largest number
constexpr double of_energy = 1e-3;      // of ∂E/∂δ from N
constexpr double of_springs = 1e-2;     // of stiffness and damping from differences
constexpr double on_surface = 1e-6;     // largest distance of a support point, relative to the size
constexpr double off_direction = 1e-4;  // largest angle of its normal [rad]

std::string number(double value) { return io::formatted("%.4g", value); }

/// The derivative of a number by differences, NaN where it is not accurate
template <class Function>
double slope(const Function& f, double h)
{
    try {
        return dae::derivative([&](double s) { return RowValues(RowValues::Constant(1, f(s))); }, 1, h,
                               "")[0];
    } catch (const lie::NumericalFailure&) {
        return std::numeric_limits<double>::quiet_NaN();
    }
}

bool differ(double given, double by_differences, double most)
{
    const double size = std::max(std::abs(given), std::abs(by_differences));
    return std::isfinite(by_differences) && !(std::abs(given - by_differences) <= most * size);
}

class SurfaceCheck {
public:
    SurfaceCheck(const Surface& surface, std::string owner, DerivativeFindings& out)
        : surface(surface), length(surface.size() > 0 ? surface.size() : 1),
          owner(std::move(owner) + ", surface '" + surface.name() + "': "), out(out)
    {}

    /// Adds the first finding.
    void run() const
    {
        const std::array<Vec3, 4> directions = {Vec3(0.48, 0.6, 0.64), Vec3(-0.36, 0.8, -0.48),
                                                Vec3(0.64, -0.6, -0.48), Vec3(-0.6, -0.48, 0.64)};
        for (const Vec3& u : directions) {
            try {
                if (surface.convex() && !has_right_support(u)) return;
                const Vec3 a = surface.project(length * u);
                for (const double aside : {0., 1e-3, -1e-3})
                    if (!is_right_at(a + aside * length * u)) return;
            } catch (const lie::NumericalFailure&) {  // no projection, or outside of the surface
            }
        }
    }

private:
    /// Whether the functions at a are right
    bool is_right_at(const Vec3& a) const
    {
        const Surface::Derivatives all = surface.derivatives(a);
        const Vec3 gradient = surface.gradient(a);
        const Mat3 hessian = surface.hessian(a);
        const double scale_0 = std::max(std::abs(all.G), length * gradient.norm());
        if (!(std::abs(all.G - surface.value(a)) <= of_surface * scale_0))
            return add("G of derivatives() is " + number(all.G) + ", value() is " + number(surface.value(a)),
                       a);
        return compare("gradient of derivatives()", all.gradient, gradient, 0, a) &&
               compare("Hessian of derivatives()", all.hessian, hessian, gradient.norm() / length, a) &&
               compare_with_differences<1>(
                   "gradient", gradient,
                   [&](const Vec3& p) { return RowValues::Constant(1, surface.value(p)); }, 0, a) &&
               compare_with_differences<3>(
                   "Hessian", hessian, [&](const Vec3& p) { return RowValues(surface.gradient(p)); },
                   gradient.norm() / length, a);
    }

    bool has_right_support(const Vec3& u) const
    {
        const std::optional<Vec3> p = surface.support(u);
        if (!p) return true;
        const Vec3 gradient = surface.gradient(*p);
        const double distance = std::abs(surface.value(*p)) / gradient.norm();
        if (!(distance <= on_surface * length))
            return add("the support point is " + number(distance) + " m from the surface", *p);
        const double angle = std::atan2(gradient.cross(u).norm(), gradient.dot(u));
        if (!(angle <= off_direction))
            return add("the gradient at the support point is " + number(angle) +
                           " rad from the direction of the support point",
                       *p);
        return true;
    }

    bool add(const std::string& text, const Vec3& at) const
    {
        out.add(owner + text + ", at (" + number(at.x()) + ", " + number(at.y()) + ", " + number(at.z()) +
                ")");
        return false;
    }

    /// size: a value that counts as large although both are small
    template <class Values>
    bool compare(const char* what, const Values& given, const Values& other, double size, const Vec3& a) const
    {
        Eigen::Index row = 0, column = 0;
        const double largest = (given - other).cwiseAbs().maxCoeff(&row, &column);
        size = std::max({size, given.cwiseAbs().maxCoeff(), other.cwiseAbs().maxCoeff()});
        if (largest <= of_surface * size) return true;
        const std::string place =
            given.cols() == 1 ? "component " + std::to_string(row + 1)
                              : "entry (" + std::to_string(row + 1) + ", " + std::to_string(column + 1) + ")";
        return add(place + " of the " + what + " is " + number(given(row, column)) + ", not " +
                       number(other(row, column)),
                   a);
    }

    template <int rows, class Values, class Function>
    bool compare_with_differences(const char* what, const Values& given, const Function& f, double size,
                                  const Vec3& a) const
    {
        Eigen::Matrix<double, 3, rows> differences;
        try {
            for (int k = 0; k < 3; ++k)
                differences.row(k) =
                    dae::derivative([&](double s) { return RowValues(f(a + s * Vec3::Unit(k))); }, 1,
                                    first_step * length, what)
                        .transpose();
        } catch (const lie::NumericalFailure&) {
            return true;  // there is nothing to compare with
        }
        return compare(what, given, Values(differences), size, a);
    }

    const Surface& surface;
    const double length;
    const std::string owner;
    DerivativeFindings& out;
};

}  // namespace

void check_surfaces(const Shape& i, const Shape& j, const std::string& owner, DerivativeFindings& out)
{
    for (const Shape* shape : {&i, &j})
        if (const Surface& surface = *shape->surface; out.is_next(typeid(surface)))
            SurfaceCheck(surface, owner, out).run();
}

void check_normal_law(const NormalLaw& law, const NormalInput& at, const std::string& owner,
                      DerivativeFindings& out)
{
    const double largest = at.overlap;
    if (!(largest > 0)) return;
    for (const double part : {1., 0.3, 0.1}) {
        NormalInput p = at;
        p.overlap = part * largest, p.overlap_rate = 0;
        const double N = law.force(p), K = law.stiffness(p), D = law.damping(p);
        if (!(N > 0)) continue;
        const auto with = [&](double NormalInput::*of, double value) {
            NormalInput q = p;
            q.*of = value;
            return q;
        };
        const double by_overlap =
            slope([&](double s) { return law.force(with(&NormalInput::overlap, p.overlap * (1 + s))) / N; },
                  first_step) *
            N / p.overlap;
        // a rate that changes N by about the same fraction
        const double rate = D > 0 ? N / D : std::sqrt(std::max(K, N / p.overlap) / p.m) * p.overlap;
        const double by_rate =
            slope([&](double s) { return law.force(with(&NormalInput::overlap_rate, rate * s)) / N; },
                  first_step) *
            N / rate;
        const double by_energy =
            slope(
                [&](double s) {
                    return law.energy(with(&NormalInput::overlap, p.overlap * (1 + s))) / (N * p.overlap);
                },
                first_step) *
            N;
        const auto add = [&](const std::string& text) {
            out.add(owner + ", normal law: " + text + ", at an overlap of " + number(p.overlap) + " m");
        };
        const auto contradicts = [&](const std::string& text, double by_differences) {
            add(text + ", differences of force have " + number(by_differences));
        };
        if (differ(K, by_overlap, of_springs) && !(std::abs(K - by_overlap) <= 1e-6 * N / p.overlap))
            return contradicts("stiffness is " + number(K), by_overlap);
        if (differ(D, by_rate, of_springs) && !(std::abs(D - by_rate) <= 1e-6 * N / rate))
            return contradicts("damping is " + number(D), by_rate);
        // a law without a spring has no energy
        if ((K != 0 || by_energy != 0) && differ(N, by_energy, of_energy))
            return add("force is " + number(N) + ", differences of energy have " + number(by_energy));
        if (!law.needs_curvature() && p.curvature > 0 &&
            law.force(with(&NormalInput::curvature, 1.5 * p.curvature)) != N)
            return add("force depends on the curvature, but needs_curvature() is false");
    }
}

void check_friction_law(const FrictionModel& friction, const ContactState& at, const std::string& owner,
                        DerivativeFindings& out)
{
    if (!(at.N > 0)) return;
    const Springs springs = friction.springs(at);
    const Vec3 u = at.slip.u;
    const Rates still{.s = Vec3::Zero(), .p_i = Vec3::Zero(), .p_j = Vec3::Zero(), .psi = 0};
    const auto of_deflection = [&](double S) {
        Deflections deflections;
        deflections.S = {S, 0};
        return friction.load(at, still, deflections).F.dot(u);
    };
    const auto of_rate = [&](double s) {
        Rates rates = still;
        rates.s = s * u;
        return friction.load(at, rates, {}).F.dot(u);
    };
    // The force is below its bound if it is proportional.
    const auto compare = [&](const char* what, const auto& force, double stiffness) {
        const double small = stiffness > 0 ? 1e-4 * at.N / stiffness : 0;
        if (!(small > 0)) return;
        const double one = force(small), two = force(2 * small), back = force(-small);
        const bool proportional =
            std::abs(two - 2 * one) <= 1e-6 * std::abs(two) && std::abs(one + back) <= 1e-6 * std::abs(one);
        if (proportional && one != 0 && differ(stiffness, one / small, of_springs))
            out.add(owner + ", friction law: " + what + " of springs() is " + number(stiffness) +
                    ", differences of load() have " + number(one / small));
    };
    compare("K_slide", of_deflection, springs.K_slide);
    compare("D_slide", of_rate, springs.D_slide);
}

}  // namespace hilda::contact
