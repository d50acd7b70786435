// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/curves/sampled_curve.hpp"

#include "lie/check.hpp"

#include <Eigen/SparseLU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace hilda::dae {

namespace {

/// Throws for samples that have no spline.
void check(const std::vector<double>& t, std::span<const double> f)
{
    if (t.size() != f.size())
        lie::reject("samples", "there must be as many values as times; values", f.size());
    if (t.size() < SampledCurve::least)
        lie::reject("samples", "a curve needs at least 6 samples; their number", t.size());
    // The matrix of the spline, whose entries are quotients of differences of the times, is singular to
    // working precision below this.
    const double nearest = 1e-12 * (t.back() - t.front());
    for (std::size_t k = 0; k < t.size(); ++k) {
        const std::string at = "sample " + std::to_string(k);
        if (!std::isfinite(t[k]) || !std::isfinite(f[k]))
            lie::reject(at, "time and value must be finite", std::isfinite(t[k]) ? f[k] : t[k]);
        if (k > 0 && !(t[k] > t[k - 1]))
            lie::reject(at, "the times must be ascending; after " + std::to_string(t[k - 1]), t[k]);
        if (k > 0 && std::isfinite(nearest) && !(t[k] - t[k - 1] > nearest))
            lie::reject(at,
                        "the times must be more than 1e-12 of the whole record apart, " +
                            io::shortest(nearest) + " s; after the sample before",
                        t[k] - t[k - 1]);
    }
}

}  // namespace

SampledCurve::SampledCurve(std::vector<double> t, std::span<const double> f)
{
    check(t, f);
    begin = t.front(), end = t.back();
    const auto n = static_cast<Eigen::Index>(t.size());
    Spline::ParameterVectorType u(n);
    for (Eigen::Index k = 0; k < n; ++k) u[k] = (t[static_cast<std::size_t>(k)] - begin) / (end - begin);
    margin = std::max(t[1] - t[0], end - t[t.size() - 2]);
    Spline::KnotVectorType knots;
    Eigen::KnotAveraging(u, degree, knots);
    std::vector<Eigen::Triplet<double>> entries;
    for (Eigen::Index k = 0; k < n; ++k) {
        const Eigen::DenseIndex span = Spline::Span(u[k], degree, knots);
        const Spline::BasisVectorType N = Spline::BasisFunctions(u[k], degree, knots);
        for (int r = 0; r <= degree; ++r)
            entries.emplace_back(static_cast<int>(k), static_cast<int>(span) - degree + r, N[r]);
    }
    Eigen::SparseMatrix<double> collocation(n, n);
    collocation.setFromTriplets(entries.begin(), entries.end());
    Eigen::SparseLU<Eigen::SparseMatrix<double>> lu(collocation);
    const Eigen::VectorXd values = Eigen::Map<const Eigen::VectorXd>(f.data(), n);
    if (lu.info() != Eigen::Success)
        lie::reject("samples", "their times have no spline; " + lu.lastErrorMessage() + "; number of samples",
                    n);
    Eigen::VectorXd points = lu.solve(values);
    points += lu.solve(values - collocation * points);
    const double residual = (values - collocation * points).lpNorm<Eigen::Infinity>();
    if (!(residual <= 1e-9 * values.lpNorm<Eigen::Infinity>()))
        lie::reject("samples",
                    "the spline does not pass through them, because their times are too close; residual",
                    residual);
    spline = Spline(knots, points.transpose());
}

io::Jet SampledCurve::jet(double time) const
{
    if (!(time >= begin - margin && time <= end + margin)) {
        std::ostringstream what;
        what << "a prescribed motion has samples from " << begin << " s to " << end << " s; it is needed at "
             << time << " s";
        throw lie::NumericalFailure("motion_ended", what.str());
    }
    const double length = end - begin;
    const auto f = spline.derivatives<2>((time - begin) / length);
    return {f(0, 0), f(0, 1) / length, f(0, 2) / (length * length)};
}

double SampledCurve::next_knot(double time) const
{
    const auto& knots = spline.knots();
    const double u = (time - begin) / (end - begin);
    const double* const next = std::upper_bound(knots.data(), knots.data() + knots.size(), u);
    if (next == knots.data() + knots.size()) return std::numeric_limits<double>::infinity();
    return std::max(begin + *next * (end - begin), std::nextafter(time, end + 1));
}

}  // namespace hilda::dae
