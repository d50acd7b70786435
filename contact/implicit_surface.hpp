// SPDX-License-Identifier: GPL-3.0-or-later
/// A surface from one formula, differentiated without being asked.

#pragma once

#include "contact/dual.hpp"
#include "contact/surface.hpp"
#include "contact/surfaces/positive.hpp"

namespace hilda::contact {

/// G(x, y, z) = 0 for any formula that can be written for numbers and Duals alike:
///
///     const ImplicitSurface egg([](auto x, auto y, auto z) { return x*x + y*y + z*z*(1 + 0.3*z) - 1.0; }, 1.0);
///
/// G should grow by about 1 per metre near the surface, and have second derivatives there. Its origin should
/// lie inside the surface: the search for a first touch starts there.
template <class F>
class ImplicitSurface final : public Surface {
public:
    /// G < 0 inside; a hollow, touched from inside, where concave. `size` [m] as Surface::size().
    /// InvalidInput unless it is positive.
    ImplicitSurface(F G, double size, bool concave = false)
        : G(std::move(G)), length(positive("contact::ImplicitSurface", "the size of a surface", size)),
          concave(concave)
    {}

    std::string name() const override { return "implicit surface"; }
    double value(const Vec3& a) const override { return G(a.x(), a.y(), a.z()); }
    Vec3 gradient(const Vec3& a) const override { return dual(a).g; }
    Mat3 hessian(const Vec3& a) const override { return dual(a).hessian(); }
    Derivatives derivatives(const Vec3& a) const override
    {
        const Dual d = dual(a);
        return {d.f, d.g, d.hessian()};
    }
    double sigma() const override { return concave ? -1 : 1; }
    double size() const override { return length; }

private:
    Dual dual(const Vec3& a) const
    {
        return G(Dual::variable(a.x(), 0), Dual::variable(a.y(), 1), Dual::variable(a.z(), 2));
    }

    const F G;
    const double length;
    const bool concave;
};

}  // namespace hilda::contact
