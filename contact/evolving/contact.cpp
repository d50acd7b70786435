// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/evolving/contact.hpp"

#include "contact/derivative_check.hpp"
#include "contact/tangent_basis.hpp"
#include "lie/check.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>

namespace hilda::contact {

namespace {

// Lower limit of the smaller eigenvalue of K_i + K_j, times L. Below it the contact points are not determined
// (line contact, matching curvatures).
constexpr double min_relative_curvature = 1e-6;
constexpr int max_iterations = 50;

/// Throws lie::InvalidInput if neither surface has a size.
double characteristic_length(const Shape& i, const Shape& j)
{
    const double L = smaller_size(i, j);
    if (!std::isfinite(L))
        lie::reject("contact::EvolvingContact", "at least one of the two surfaces must be curved",
                    i.surface->name() + " and " + j.surface->name());
    return L;
}

/// |∇G|. `a` is the point in the surface frame [m], for the message. Throws lie::NumericalFailure
/// "contact_lost" if the gradient vanishes or is not a number.
double gradient_norm(const Vec3& gradient, const Vec3& a)
{
    const double g = gradient.norm();
    if (g > 0) return g;
    std::ostringstream what;
    what << "a surface has no normal at (" << a.x() << ", " << a.y() << ", " << a.z()
         << "), in its own frame: the gradient vanishes there";
    throw lie::NumericalFailure("contact_lost", what.str());
}

/// The normal force from the multipliers of a contact; n: its normal
double normal_force(const dae::Constraint::Arguments& x, const Vec3& n)
{
    const Vec3 Psi = x.lambda->segment<3>(x.row);
    return Psi.dot(n) > 0 ? Psi.norm() : 0;
}

/// Whether a friction force is at its bound
bool is_at_bound(const Eigen::Vector2d& lambda, double bound)
{
    constexpr double tolerance = 1e-4;  // relative; above the tolerance of lie::BoundedRows
    return lambda.norm() > (1 - tolerance) * bound;
}

}  // namespace

/// Contact point, normal and surface function of one body, in global axes
struct EvolvingContact::Side {
    Vec3 arm;  // A ᾱ [m]
    Vec3 n;    // A n̄
    double G;  // G/|∇G| [m]

    Side(const Shape& shape, const Motion& body, const double* alpha)
    {
        const Vec3 a = shape.to_surface(Vec3::Map(alpha)), gradient = shape.surface->gradient(a);
        const double g = gradient_norm(gradient, a);
        arm = body.A * Vec3::Map(alpha);
        n = shape.surface->sigma() / g * (body.A * (shape.orientation * gradient));
        G = shape.surface->value(a) / g;
    }
};

namespace {

/// The quantities of Side, and the second derivatives of the surface
struct CurvedSide {
    Vec3 arm, n, u, a;  // u = ∇G/|∇G| in global axes; a: the point in the surface frame
    double G, g;        // G/|∇G|, |∇G|
    Mat3 axes;          // from the surface frame to global axes
    Mat3 H;             // ∇²G/|∇G| in global axes
    Mat3 dn;            // ∂n/∂(A ᾱ) = σ (I - u uᵀ) H
    double sigma;

    CurvedSide(const Shape& shape, const Motion& body, const double* alpha)
    {
        a = shape.to_surface(Vec3::Map(alpha));
        const Surface::Derivatives d = shape.surface->derivatives(a);
        g = gradient_norm(d.gradient, a);
        axes = body.A * shape.orientation;
        sigma = shape.surface->sigma();
        arm = body.A * Vec3::Map(alpha);
        u = axes * d.gradient / g;
        n = sigma * u;
        G = d.G / g;
        H = axes * d.hessian * axes.transpose() / g;
        dn = sigma * (H - u * (u.transpose() * H));
    }
    Mat3 shape_operator() const { return dn - (dn * u) * u.transpose(); }
};

}  // namespace

EvolvingContact::EvolvingContact(int i, const Shape& shape_i, int j, const Shape& shape_j, Friction friction,
                                 NormalRows normal_rows, const Unilateral& unilateral)
    : EvolvingContact(i, shape_i, j, shape_j, friction, {}, normal_rows, unilateral)
{}

EvolvingContact::EvolvingContact(int i, const Shape& shape_i, int j, const Shape& shape_j,
                                 const ImplicitFriction& law, NormalRows normal_rows,
                                 const Unilateral& unilateral)
    : EvolvingContact(i, shape_i, j, shape_j, Friction::implicit, law, normal_rows, unilateral)
{}

EvolvingContact::EvolvingContact(int i, const Shape& shape_i, int j, const Shape& shape_j, Friction friction,
                                 const ImplicitFriction& law, NormalRows normal_rows,
                                 const Unilateral& unilateral)
    : ContactConstraint(i, j), shape_i(shape_i), shape_j(shape_j), L(characteristic_length(shape_i, shape_j)),
      friction(friction), law(law), normal_rows(normal_rows), unilateral(unilateral),
      common_normal(shape_i, shape_j), detector(make_detector(shape_i, shape_j)),
      other_points(OtherPoints::of(shape_i, shape_j))
{
    if (is_regularised()) law.validate();
    if (!(unilateral.restitution >= 0 && unilateral.restitution <= 1))
        lie::reject("contact::EvolvingContact", "the restitution must be from 0 to 1",
                    unilateral.restitution);
}

EvolvingContact::Mat32 EvolvingContact::tangents(const Arguments& x) const
{
    if (normal_rows == NormalRows::fixed_xy) return Mat3::Identity().leftCols<2>();
    return restored<NodeState>(x.internal_state).T;
}

EvolvingContact::Mat32 EvolvingContact::projected_tangents(const Arguments& x, const Vec3& n) const
{
    const Mat32 T = restored<NodeState>(x.internal_state).T;
    return T - n * (n.transpose() * T);
}

void EvolvingContact::phi(const Arguments& x, double* out) const
{
    const Side side_i(shape_i, x.bi, x.alpha), side_j(shape_j, x.bj, x.alpha + 3);
    Vec3::Map(out) = (x.bi.r - x.bj.r) + (side_i.arm - side_j.arm);
    Eigen::Vector2d::Map(out + 3) = L * (tangents(x).transpose() * (side_i.n + side_j.n));
    out[5] = side_i.G, out[6] = side_j.G;
}

void EvolvingContact::variation(const Arguments& x, Derivatives& out) const
{
    const CurvedSide side_i(shape_i, x.bi, x.alpha), side_j(shape_j, x.bj, x.alpha + 3);
    const Mat32 T = tangents(x);
    Mat32 T_slip = Mat32::Zero(), T_roll = Mat32::Zero();  // transposed rows of slip and of rolling
    if (friction != Friction::none) T_slip = projected_tangents(x, side_i.n);
    if (law.has_rolling_resistance())
        T_roll = -lie::tilde(side_i.n) *
                 lever_arms(side_i.shape_operator() + side_j.shape_operator(), side_i.n) * T_slip;
    const auto fill = [&](const CurvedSide& side, const Motion& body, double sign, auto& C_body, int column) {
        // The derivative of A ᾱ with respect to δθ̄ is -A ᾱ~ = -(Aᾱ)~ A.
        C_body.template block<3, 3>(0, 0) = sign * Mat3::Identity();
        C_body.template block<3, 3>(0, 3) = -sign * (lie::tilde(side.arm) * body.A);
        C_body.template block<2, 3>(3, 3) = -L * (T.transpose() * lie::tilde(side.n) * body.A);
        out.Phi_alpha.template block<3, 3>(0, column) = sign * body.A;
        out.Phi_alpha.template block<2, 3>(3, column) = L * (T.transpose() * side.dn * body.A);
        out.Phi_alpha.template block<1, 3>(column == 0 ? 5 : 6, column) = side.u.transpose() * body.A;
        if (friction == Friction::none) return;
        C_body.template block<2, 3>(7, 0) = sign * T_slip.transpose();
        C_body.template block<2, 3>(7, 3) = -sign * (T_slip.transpose() * lie::tilde(side.arm) * body.A);
        if (law.has_rolling_resistance())
            C_body.template block<2, 3>(9, 3) = sign * (T_roll.transpose() * body.A);
    };
    fill(side_i, x.bi, 1, out.C_i, 0);
    fill(side_j, x.bj, -1, out.C_j, 3);
}

void EvolvingContact::gamma(const Arguments& x, double* out) const
{
    const CurvedSide side_i(shape_i, x.bi, x.alpha), side_j(shape_j, x.bj, x.alpha + 3);
    const Vec3 n = side_i.n;
    const Vec3 omega_i = x.bi.A * x.bi.omega_bar, omega_j = x.bj.A * x.bj.omega_bar;

    // Contact equations of Montana (1988) in coordinate-free form, with the slip velocity s:
    //     (K_i + K_j) A_i ᾱ̇_i = n × (ω_i - ω_j) - K_j s,    (K_i + K_j) A_j ᾱ̇_j = n × (ω_i - ω_j) + K_i s
    const Mat32 T = tangent_basis(n);
    const Vec3 slip = dae::velocity_at(x.bi, side_i.arm) - dae::velocity_at(x.bj, side_j.arm),
               n_cross_omega = n.cross(omega_i - omega_j);
    const Mat3 K_i = side_i.shape_operator(), K_j = side_j.shape_operator();
    const Eigen::Matrix2d K = T.transpose() * (K_i + K_j) * T;
    const Eigen::Matrix2d inverse = K.inverse();
    const Vec3 adot_i = T * (inverse * (T.transpose() * (n_cross_omega - K_j * slip)));
    const Vec3 adot_j = T * (inverse * (T.transpose() * (n_cross_omega + K_i * slip)));

    const auto differentiate = [&](const Shape& shape, const CurvedSide& side, const Vec3& omega,
                                   const Vec3& adot, Vec3& point, Vec3& normal, double& surface_row,
                                   Vec3& material) {
        const Vec3 centripetal = omega.cross(omega.cross(side.arm));
        point = centripetal + 2 * omega.cross(adot);
        material = centripetal + omega.cross(adot);
        surface_row = -adot.dot(side.H * adot);
        // ᾱ̇ᵀ (∂²n/∂ᾱ²) ᾱ̇ needs third derivatives of G. They are computed by central differences of ∂n/∂ᾱ
        // along ᾱ̇.
        Vec3 third_derivative = Vec3::Zero();
        if (const double speed = adot.norm(); speed > 0) {
            const double step = 1e-5 * L;
            const Vec3 along = side.axes.transpose() * (adot / speed);
            third_derivative =
                speed * speed *
                (side.axes * (shape.surface->normal_derivative(side.a + step * along) * along -
                              shape.surface->normal_derivative(side.a - step * along) * along)) /
                (2 * step);
        }
        normal = omega.cross(omega.cross(side.n)) + 2 * omega.cross(side.dn * adot) + third_derivative;
    };
    Vec3 point_i, point_j, normal_i, normal_j, material_i, material_j;
    differentiate(shape_i, side_i, omega_i, adot_i, point_i, normal_i, out[5], material_i);
    differentiate(shape_j, side_j, omega_j, adot_j, point_j, normal_j, out[6], material_j);
    Vec3::Map(out) = point_j - point_i;
    Eigen::Vector2d::Map(out + 3) = -L * (tangents(x).transpose() * (normal_i + normal_j));
    if (friction != Friction::none)
        Eigen::Vector2d::Map(out + 7) = projected_tangents(x, n).transpose() * (material_j - material_i);
    // γ of a regularised row is used at starts and restarts only. Zero is exact if the bodies do not roll
    // then.
    if (law.has_rolling_resistance()) Eigen::Vector2d::Map(out + 9).setZero();
}

Mat3 EvolvingContact::lever_arms(const Mat3& K_sum, const Vec3& n) const
{
    const Mat32 T = tangent_basis(n);
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> kappa;
    kappa.computeDirect(T.transpose() * K_sum * T);
    const Eigen::Vector2d max_lever_arm = Eigen::Vector2d::Constant(10 * L);
    const Mat32 along = T * kappa.eigenvectors();
    return along * kappa.eigenvalues().cwiseInverse().cwiseMin(max_lever_arm).asDiagonal() *
           along.transpose();
}

void EvolvingContact::set_pairs(const Arguments& x, lie::BoundedPair* out) const
{
    const Vec3 n = Side(shape_i, x.bi, x.alpha).n;
    const auto set_pair = [&](lie::BoundedPair& pair, const NodeState::Pair& saved, double K, double D,
                              double factor) {
        pair.K = K, pair.D = D, pair.n = n;
        pair.S = saved.S;
        pair.mu = factor * (saved.slipping != 0 ? law.mu_k : law.mu_s);
    };
    const auto state = restored<NodeState>(x.internal_state);
    set_pair(out[sliding_pair], state.sliding, law.K_E, law.K_D, 1);
    if (!law.has_rolling_resistance()) return;
    const ContactPoint at = contact_point(x);
    const double kappa = 2 / lever_arms(at.K_i + at.K_j, n).trace();
    set_pair(out[rolling_pair], state.rolling, 4 * law.eta_r * law.K_E,
             law.D_roll * kappa * kappa + law.D_kappa * kappa, 2 * law.eta_r);
    out[rolling_pair].solved_first = true;
}

/// Updates S, Z and the slip flags from the multipliers of the last step (see ImplicitFriction). They are set
/// to zero at a start and for an inactive contact.
void EvolvingContact::update_friction(const Arguments& x, bool start, NodeState& state) const
{
    const double h = start ? 0 : x.t - state.t;
    state.t = x.t;
    if (start || x.mode != active) {
        for (NodeState::Pair* saved : {&state.sliding, &state.rolling})
            saved->S.setZero(), saved->slipping = 0;
        return;
    }
    lie::BoundedPair pair[2];
    set_pairs(x, pair);
    const double N = normal_force(x, pair[sliding_pair].n);
    for (const RowPair p : {sliding_pair, rolling_pair}) {
        if (p == rolling_pair && !law.has_rolling_resistance()) continue;
        NodeState::Pair& saved = p == sliding_pair ? state.sliding : state.rolling;
        const lie::BoundedPair& c = pair[p];
        const Eigen::Vector2d lambda = x.lambda->segment<2>(x.velocity_row + 2 * p);
        saved.S += h * c.mobility(h) * (lambda - c.K * c.S);
        saved.slipping = is_at_bound(lambda, c.mu * N);
    }
}

void EvolvingContact::set_static_pairs(const Arguments& x, const bool* at_rest, double* internal_state) const
{
    if (x.mode != active || !law.static_start) return;
    auto state = restored<NodeState>(internal_state);
    lie::BoundedPair pair[2];
    set_pairs(x, pair);
    const double N = normal_force(x, pair[sliding_pair].n);
    for (const RowPair p : {sliding_pair, rolling_pair}) {
        if (p == rolling_pair && !law.has_rolling_resistance()) continue;
        if (!at_rest[p]) continue;
        NodeState::Pair& saved = p == sliding_pair ? state.sliding : state.rolling;
        const lie::BoundedPair& c = pair[p];
        const Eigen::Vector2d lambda = x.lambda->segment<2>(x.velocity_row + 2 * p);
        saved.slipping = is_at_bound(lambda, c.mu * N);
        saved.S = (saved.slipping != 0 ? law.mu_k / law.mu_s : 1) / c.K * lambda;
    }
    save(state, internal_state);
}

unsigned EvolvingContact::nonzero(int row) const
{
    constexpr unsigned rotation = 0b111000;
    if (row < 3) {
        const unsigned one_body = 1u << row | rotation;
        return one_body | one_body << 6;
    }
    if (row < 5) return rotation | rotation << 6;
    if (row < 7) return 0;
    if (row > 8) return rotation | rotation << 6;
    return 0b111111111111;
}

ContactPoint EvolvingContact::contact_point(const Arguments& x) const
{
    const CurvedSide side_i(shape_i, x.bi, x.alpha), side_j(shape_j, x.bj, x.alpha + 3);
    ContactPoint contact_point;
    contact_point.C_i = x.bi.r + side_i.arm, contact_point.C_j = x.bj.r + side_j.arm;
    contact_point.n = side_j.n;
    contact_point.gap = contact_point.n.dot((x.bi.r - x.bj.r) + (side_i.arm - side_j.arm));
    contact_point.K_i = side_i.shape_operator(), contact_point.K_j = side_j.shape_operator();
    return contact_point;
}

void EvolvingContact::check_derivatives(dae::DerivativeFindings& out) const
{
    check_surfaces(shape_i, shape_j, label(), out);
}

void EvolvingContact::update_alpha(const Arguments& x, bool global_search, double* alpha) const
{
    Vec3 a_i = Vec3::Zero(), a_j = Vec3::Zero();
    bool found = false;
    if (!global_search) {
        CommonNormal::Pair p = common_normal.placed(x.bi, x.bj);
        p.a_i = shape_i.to_surface(Vec3::Map(x.alpha)), p.a_j = shape_j.to_surface(Vec3::Map(x.alpha + 3));
        for (int k = 0; k < max_iterations && !found; ++k) {
            const double correction = common_normal.newton_step(p);
            if (!std::isfinite(correction)) break;
            found = correction < 1e-12 * L;
        }
        // Points of a saddle or a maximum of the distance, such as those across the hole of a torus, satisfy
        // the same equations.
        if (found && other_points && x.mode == inactive) found = common_normal.is_nearest(p);
        a_i = shape_i.to_body(p.a_i), a_j = shape_j.to_body(p.a_j);
    }
    if (!found) {
        const ContactPoint at = detector->detect(x.bi, x.bj, nullptr);
        a_i = x.bi.A.transpose() * (at.C_i - x.bi.r);
        a_j = x.bj.A.transpose() * (at.C_j - x.bj.r);
    }
    Vec3::Map(alpha) = a_i;
    Vec3::Map(alpha + 3) = a_j;
}

int EvolvingContact::update_mode(const Arguments& x, bool start, double* internal_state) const
{
    if (x.mode == fallback_active) return fallback_active;
    const ContactPoint at = contact_point(x);
    const auto fail = [&](const std::string& status, const std::string& what, double value) -> int {
        if (fallback) return fallback_active;
        std::ostringstream text;
        text.precision(3);
        text << "contact '" << name << "': " << what << ' ' << value;
        throw lie::NumericalFailure(status, text.str());
    };
    const Vec3 n_i = Side(shape_i, x.bi, x.alpha).n;
    if (x.mode == active) {
        if (const double n_dot_n = n_i.dot(at.n); !(n_dot_n < -0.5))
            return fail("contact_lost",
                        "the normals are no longer opposite; n_i . n_j must be below -0.5, got", n_dot_n);
        if (const double least = least_curvature(at) * L; !(least > min_relative_curvature))
            return fail("contact_singular",
                        "the contact point is not unique, because the curvatures match; the smaller "
                        "eigenvalue of K_i + K_j times the size of the surfaces must exceed 1e-6, got",
                        least);
    }
    auto state = restored<NodeState>(internal_state);
    if (start) {
        state.T = tangent_basis(n_i);
        state.last_rebound = -std::numeric_limits<double>::infinity();
    } else {
        const Vec3 before = state.T.col(0), along = before - n_i * n_i.dot(before);
        state.T.col(0) = along.norm() > 0.1 ? Vec3(along.normalized()) : Vec3(tangent_basis(n_i).col(0));
        state.T.col(1) = n_i.cross(state.T.col(0));
    }
    if (is_regularised()) update_friction(x, start, state);
    save(state, internal_state);
    if (other_points) {
        auto last = restored<OtherPoints::Pose>(internal_state + reals<NodeState>());
        other_points->check(name, x.bi, x.bj, at, last);
        save(last, internal_state + reals<NodeState>());
    }
    return x.mode;
}

double EvolvingContact::separation_speed(const Arguments& x) const
{
    const ContactPoint at = contact_point(x);
    return at.n.dot(dae::velocity_at(x.bi, at.C_i - x.bi.r) - dae::velocity_at(x.bj, at.C_j - x.bj.r));
}

dae::ContactConstraint::Violation EvolvingContact::position_violation(const Arguments& x, double) const
{
    return {std::abs(gap(x)), 1e-6 * L, "not in contact at the start, the gap or overlap is", "m"};
}

dae::ContactConstraint::Violation EvolvingContact::velocity_violation(const Arguments& x,
                                                                      double tolerance) const
{
    const ContactPoint at = contact_point(x);
    const Vec3 slip = dae::velocity_at(x.bi, at.C_i - x.bi.r) - dae::velocity_at(x.bj, at.C_j - x.bj.r);
    return {friction == Friction::rolling ? slip.norm() : std::abs(at.n.dot(slip)), tolerance,
            "the initial velocities violate the contact by", "m/s"};
}

int EvolvingContact::start(const Arguments& x, double* alpha) const
{
    if (const std::string reason = start_error(x); !reason.empty()) {
        if (!fallback) throw lie::InvalidInput(reason);
        try {
            update_alpha(x, true, alpha);  // for output only
        } catch (const lie::NumericalFailure&) {
        }
        return fallback_active;
    }
    update_alpha(x, true, alpha);
    constexpr double max_rest_speed = 1e-9;  // [m/s], above the rounding error of a speed of zero
    const double distance = gap(x), tolerance = 1e-6 * L;
    const bool open =
        distance > tolerance || (distance > -tolerance && std::abs(separation_speed(x)) > max_rest_speed);
    return unilateral.enabled && open ? inactive : active;
}

std::string EvolvingContact::start_error(const Arguments& x) const
{
    if (std::string why = common_normal.width_conflict(x.bi, x.bj); !why.empty()) return why;
    ContactPoint at;
    try {
        at = detector->detect(x.bi, x.bj, nullptr);
    } catch (const NoUniqueContactPoint& e) {
        return e.what();
    }
    // normal() throws if the surface has no normal at the point.
    shape_i.surface->normal(shape_i.to_surface(x.bi.A.transpose() * (at.C_i - x.bi.r)));
    shape_j.surface->normal(shape_j.to_surface(x.bj.A.transpose() * (at.C_j - x.bj.r)));
    const double least = least_curvature(at);
    if (least * L > min_relative_curvature) return {};
    std::ostringstream what;
    what.precision(6);
    if (least < -min_relative_curvature / L)
        what << "a surface does not fit into the other: the sum of their curvatures must be positive, got ";
    else
        what << "the surfaces touch along a line or a face and have no unique contact point: the smaller "
                "eigenvalue of the sum of their curvatures must be positive, got ";
    what << least << " 1/m";
    return what.str();
}

std::string EvolvingContact::row_name(int row) const
{
    constexpr const char* names[] = {"Psi x",     "Psi y",        "Psi z",       "N 1",
                                     "N 2",       "G of i",       "G of j",      "rolling 1",
                                     "rolling 2", "resistance 1", "resistance 2"};
    constexpr const char* sliding[] = {"sliding 1", "sliding 2"};
    return is_regularised() && (row == 7 || row == 8) ? sliding[row - 7] : names[row];
}

EvolvingContact::Multipliers EvolvingContact::multipliers(const Arguments& x,
                                                          const Eigen::VectorXd& lambda) const
{
    Multipliers m;
    m.Psi = lambda.segment<3>(x.row);
    m.N = lambda.segment<2>(x.row + 3);
    m.G = lambda.segment<2>(x.row + 5);
    m.rolling.setZero();
    m.friction.setZero();
    m.resistance.setZero();
    const Vec3 n = Side(shape_i, x.bi, x.alpha).n;
    m.F_N = m.Psi.dot(n);
    m.tangential = m.Psi - m.F_N * n;
    if (friction != Friction::none) {
        m.rolling = lambda.segment<2>(x.velocity_row);
        m.friction = -projected_tangents(x, n) * m.rolling;
    }
    if (law.has_rolling_resistance()) m.resistance = lambda.segment<2>(x.velocity_row + 2);
    return m;
}

}  // namespace hilda::contact
