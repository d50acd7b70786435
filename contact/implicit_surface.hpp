// SPDX-License-Identifier: GPL-3.0-or-later
/// A surface defined by one formula G(x, y, z) = 0. The derivatives are computed by automatic differentiation
/// (Dual).

#pragma once

#include "contact/dual.hpp"
#include "contact/surface.hpp"
#include "contact/surfaces/positive.hpp"

namespace hilda::contact {

/// The surface G(x, y, z) = 0 of a generic callable G that accepts double and Dual arguments:
///
///     const auto G = [](auto x, auto y, auto z) { return x*x + y*y + z*z*(1 + 0.3*z) - 1.0; };
///     const ImplicitSurface egg(G, 1.0);
///
/// G must have second derivatives near the surface, and |∇G| should be about 1 there. The origin of the frame
/// should lie inside the surface, because the search for the first contact point starts there.
template <class F>
class ImplicitSurface final : public Surface {
public:
    /// G < 0 inside. With `concave` contact is on the inside, and the body is where G > 0. `size` [m]: see
    /// Surface::size(). InvalidInput unless the size is positive.
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
