// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/evolving/implicit_friction.hpp"

#include "lie/check.hpp"

#include <cmath>

namespace hilda::contact {

void ImplicitFriction::validate() const
{
    const auto check = [](const char* what, double value, bool valid) {
        if (!valid || !std::isfinite(value)) lie::reject("contact::ImplicitFriction", what, value);
    };
    check("mu_k must not be negative", mu_k, mu_k >= 0);
    check("mu_s must not be below mu_k", mu_s, mu_s >= mu_k);
    check("K_E must be positive", K_E, K_E > 0);
    check("K_D must not be negative", K_D, K_D >= 0);
    check("eta_r must not be negative", eta_r, eta_r >= 0);
    check("D_roll must not be negative", D_roll, D_roll >= 0);
    check("D_kappa must not be negative", D_kappa, D_kappa >= 0);
}

}  // namespace hilda::contact
