// SPDX-License-Identifier: GPL-3.0-or-later
/// Comparison of the functions of surfaces, normal laws and friction laws with differences.

#pragma once

#include "dae/start/derivative_check.hpp"

namespace hilda::contact {

struct Shape;
class NormalLaw;
class FrictionModel;
struct NormalInput;
struct ContactState;

using dae::DerivativeFindings;

/// Compares, at a few points of the surface and beside it,
///
///     ∇G with differences of G,   ∇²G with differences of ∇G,   derivatives() with all three,
///     and of a convex surface the support point with G = 0 and with the direction of ∇G.
///
/// for both surfaces of a contact. Points without a projection and functions where differences are not
/// accurate are left out. `owner` is the name of the contact in the findings, such as "contact 'ball-floor'".
void check_surfaces(const Shape& i, const Shape& j, const std::string& owner, DerivativeFindings& out);

/// Compares, at the overlap and at two smaller ones,
///
///     stiffness with ∂N/∂δ,   damping with ∂N/∂δ̇,   N with ∂E/∂δ of the elastic energy, at δ̇ = 0,
///
/// and N at two curvatures if the law says that it does not need the curvature. `at` has a positive overlap.
void check_normal_law(const NormalLaw& law, const NormalInput& at, const std::string& owner,
                      DerivativeFindings& out);

/// Compares the sliding stiffness and damping with differences of the friction force by the deflection and by
/// the slip velocity, in the stick regime and within the bound of the force: F = K S + D ṡ on body i. `at`
/// has a positive normal force.
void check_friction_law(const FrictionModel& friction, const ContactState& at, const std::string& owner,
                        DerivativeFindings& out);

}  // namespace hilda::contact
