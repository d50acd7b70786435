// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/surfaces/quadric.hpp"

#include "contact/surface_types.hpp"
#include "lie/check.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <cmath>

namespace hilda::contact {

namespace {

constexpr double rounding =
    1e-12;  // relative size below which eigenvalues and differences are treated as zero

}  // namespace

struct Quadric::Invariants {
    Vec3 lambda;    // eigenvalues of Q
    double norm;    // the largest |λ|
    Vec3 centre;    // ᾱ_0 = -Q⁺ b
    double d, G_0;  // |Q ᾱ_0 + b| and G(ᾱ_0), set to 0 if they are rounding

    Invariants(const Mat3& Q, const Vec3& b, double c)
    {
        const Eigen::SelfAdjointEigenSolver<Mat3> eigen(Q);
        lambda = eigen.eigenvalues();
        norm = lambda.cwiseAbs().maxCoeff();
        lambda = (lambda.cwiseAbs().array() > rounding * norm).select(lambda, 0);
        const Vec3 along = eigen.eigenvectors().transpose() * b;
        Vec3 x, rest;
        for (int k = 0; k < 3; ++k) {
            x[k] = lambda[k] != 0 ? -along[k] / lambda[k] : 0;
            rest[k] = lambda[k] != 0 ? 0 : along[k];
        }
        centre = eigen.eigenvectors() * x;
        d = rest.norm() > rounding * b.norm() ? rest.norm() : 0;
        G_0 = c + b.dot(centre);
        if (!(std::abs(G_0) > rounding * (std::abs(c) + std::abs(b.dot(centre))))) G_0 = 0;
    }

    double length() const { return d > 0 ? d / norm : std::sqrt(std::abs(G_0) / norm); }
};

std::string Quadric::fault(const Mat3& Q, const Vec3& b, double c)
{
    if (!Q.allFinite() || !b.allFinite() || !std::isfinite(c)) return "the coefficients must be finite";
    if (!((Q - Q.transpose()).norm() <= rounding * Q.norm())) return "Q must be symmetric";
    if (Q.norm() == 0) return "Q must not be zero; use a plane";
    const Invariants known(Q, b, c);
    if (known.d > 0) return {};
    const bool above = known.lambda.minCoeff() >= 0, below = known.lambda.maxCoeff() <= 0;
    if (known.G_0 == 0)
        return above || below ? "G = 0 must be a surface; it is a point, a line or a double plane"
                              : "G = 0 must not intersect itself; it is a double cone or two planes";
    if ((above && known.G_0 > 0) || (below && known.G_0 < 0))
        return "G = 0 must have points; G does not change its sign";
    return {};
}

Quadric::Quadric(const Mat3& Q, const Vec3& b, double c, bool concave)
    : Quadric(Q, b, c, concave, [&] {
          if (const std::string what = fault(Q, b, c); !what.empty()) {
              std::ostringstream given;
              given.precision(17);
              given << "Q = "
                    << Q.format(Eigen::IOFormat(17, Eigen::DontAlignCols, ", ", "; ", "", "", "[", "]"))
                    << ", b = " << b.transpose() << ", c = " << c;
              lie::reject("contact::Quadric", what, given.str());
          }
          return Invariants(Q, b, c);
      }())
{}

Quadric::Quadric(const Mat3& Q, const Vec3& b, double c, bool concave, const Invariants& known)
    : concave(concave), L(known.length()), definite(known.lambda.minCoeff() > 0), centre(known.centre)
{
    const double scale = 1 / (2 * known.norm * L);
    this->Q = scale * 0.5 * (Q + Q.transpose());
    this->b = scale * b;
    this->c = scale * c;
    inverse = definite ? Mat3(this->Q.inverse()) : Mat3::Zero();
}

std::optional<Vec3> Quadric::support(const Vec3& u) const
{
    if (!definite) return {};
    const Vec3 down = inverse * u;
    return Vec3(centre + std::sqrt(-value(centre) / u.dot(down)) * down);
}

namespace {

const bool registered_quadric = io::Registry<SurfaceType>::add(
    {.name = "quadric",
     .schema = {.description = "Surface G = a^T Q a + 2 b . a + c = 0 of the second degree, with a in the "
                               "surface frame. The material is where G is negative.",
                .examples = {R"("Q": [[1, 0, 0], [0, 1, 0], [0, 0, -1]], "c": -0.01)"}},
     .read = [](dae::ObjectReader& o) -> std::shared_ptr<const Surface> {
         const Mat3 Q = o.matrix("Q", {"Symmetric matrix Q, in the surface frame. It must not be zero. Its "
                                       "unit is free; it determines the units of b and c.",
                                       "[[1, 0, 0], [0, 1, 0], [0, 0, -1]]"});
         const Vec3 b =
             o.vec3("b", {"Vector b, in the surface frame. Its unit is the unit of Q times m.", "[0, 0, 0]"},
                    Vec3::Zero());
         const double c = o.number("c", {"Constant c. Its unit is the unit of Q times m^2.", "-0.01"});
         if (const std::string what = Quadric::fault(Q, b, c); !what.empty()) o.fail("Q", what);
         return std::make_shared<Quadric>(Q, b, c, read_concave(o));
     }});

}  // namespace

}  // namespace hilda::contact
