// SPDX-License-Identifier: GPL-3.0-or-later
/// Bushing: a spring and damper with six components between two bodies.
#include "dae/forces/bushing.hpp"

#include "dae/forces/row_load.hpp"
#include "dae/model_types.hpp"
#include "lie/check.hpp"

#include <cmath>

namespace hilda::dae {

Bushing::Bushing(int i, const Vec3& s_bar_i, int j, const Vec3& s_bar_j, const Coefficients& coefficients,
                 const State& start)
    : i(i), j(j), s_bar_i(s_bar_i), s_bar_j(s_bar_j),
      R_0(motion(start, i).A.transpose() * motion(start, j).A), coefficients(coefficients)
{
    for (const Vec3& k : {coefficients.stiffness, coefficients.damping, coefficients.rotational_stiffness,
                          coefficients.rotational_damping})
        if (!(k.minCoeff() >= 0) || !k.allFinite())
            lie::reject("bushing", "the coefficients must not be negative", k.transpose());
}

Bushing::Deflection Bushing::deflection(const State& x) const
{
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    const Mat3 A_ij = bi.A.transpose() * bj.A;
    return {bi.A.transpose() * (bj.r + bj.A * s_bar_j - bi.r - bi.A * s_bar_i),
            lie::log(R_0.transpose() * A_ij)};
}

void Bushing::add(const State& x, lie::Loads& out) const
{
    constexpr double max_angle = 3;  // [rad]; the rotation vector jumps at π
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    const Deflection at = deflection(x);
    if (!(at.psi.norm() < max_angle))
        throw lie::NumericalFailure("bushing_turned",
                                    label() + ": the relative rotation must be below 3 rad, got " +
                                        std::to_string(at.psi.norm()) + " rad");
    const Vec3 s_bar_q = bi.A.transpose() * (bj.r + bj.A * s_bar_j - bi.r);  // Q in the frame of body i
    const Vec3 ddot = bi.A.transpose() * (velocity_at(bj, bj.A * s_bar_j) - velocity_at(bi, bi.A * s_bar_q));
    const Vec3 F =
        -bi.A * (coefficients.stiffness.cwiseProduct(at.d) + coefficients.damping.cwiseProduct(ddot));
    apply_force(j, F, s_bar_j, x, out);
    apply_force(i, -F, s_bar_q, x, out);

    // ψ̇ = J_r(ψ)⁻¹ (ω̄_j - A_jᵀ A_i ω̄_i); the torque on body j is conjugate to ψ.
    const Mat3 J_inverse = lie::right_jacobian_inverse(at.psi), A_ji = bj.A.transpose() * bi.A;
    const Vec3 psidot = J_inverse * (bj.omega_bar - A_ji * bi.omega_bar);
    const Vec3 n_j = -J_inverse.transpose() * (coefficients.rotational_stiffness.cwiseProduct(at.psi) +
                                               coefficients.rotational_damping.cwiseProduct(psidot));
    if (j != ground) out.n_bar[j] += n_j;
    if (i != ground) out.n_bar[i] -= A_ji.transpose() * n_j;
}

int Bushing::spring_rows(const State& x, SpringRow* out) const
{
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    const Vec3 y = bi.A.transpose() * (bj.r + bj.A * s_bar_j - bi.r);  // Q in the frame of body i
    const Vec3 v = bi.A.transpose() * (velocity_at(bj, bj.A * s_bar_j) - bi.rdot);
    const Vec3 ydot = v - bi.omega_bar.cross(y);
    const Vec3 yddot = bi.A.transpose() * (bj.A * bj.omega_bar.cross(bj.omega_bar.cross(s_bar_j))) -
                       bi.omega_bar.cross(v + ydot);
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 e_i = Vec3::Unit(axis), e = bi.A * e_i;
        out[axis] = {.r_i = -e,
                     .pi_i = -y.cross(e_i),
                     .r_j = e,
                     .pi_j = s_bar_j.cross(bj.A.transpose() * e),
                     .stiffness = coefficients.stiffness[axis],
                     .damping = coefficients.damping[axis],
                     .gamma = yddot[axis]};
    }
    const Vec3 psi = deflection(x).psi, omega_i = bj.A.transpose() * (bi.A * bi.omega_bar);
    const Mat3 J_inverse = lie::right_jacobian_inverse(psi);
    const Vec3 w = bj.omega_bar - omega_i, psidot = J_inverse * w;
    // The derivative of J_r(psi)^-1 along psidot, by central differences
    const double step = 1e-5 / std::max(1e-3, psidot.norm());
    const Vec3 of_J = (lie::right_jacobian_inverse(psi + step * psidot) * w -
                       lie::right_jacobian_inverse(psi - step * psidot) * w) /
                      (2 * step);
    const Vec3 psiddot = of_J + J_inverse * bj.omega_bar.cross(omega_i);
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 of_j = J_inverse.row(axis);
        out[3 + axis] = {.r_i = Vec3::Zero(),
                         .pi_i = -(bi.A.transpose() * (bj.A * of_j)),
                         .r_j = Vec3::Zero(),
                         .pi_j = of_j,
                         .stiffness = coefficients.rotational_stiffness[axis],
                         .damping = coefficients.rotational_damping[axis],
                         .gamma = psiddot[axis]};
    }
    return 6;
}

bool Bushing::load_derivatives(const State& x, LoadDerivatives& out) const
{
    out.setZero();
    add_translations(x, out);
    add_rotations(x, out);
    return true;
}

void Bushing::add_translations(const State& x, LoadDerivatives& out) const
{
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    const Vec3 y = bi.A.transpose() * (bj.r + bj.A * s_bar_j - bi.r), d = y - s_bar_i;
    const Vec12 v = velocities(bi, bj);
    Eigen::Matrix<double, 3, 12> of_y;
    of_y << -bi.A.transpose(), lie::tilde(y), bi.A.transpose(),
        -bi.A.transpose() * bj.A * lie::tilde(s_bar_j);
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 e_i = Vec3::Unit(axis), e = bi.A * e_i, e_j = bj.A.transpose() * e;
        const Mat3 of_e = -bi.A * lie::tilde(e_i);  // by δθ̄ of body i
        RowLoad row;
        row.w << -e, -y.cross(e_i), e, s_bar_j.cross(e_j);
        row.g = row.w;
        row.W.block<3, 3>(0, 3) = -of_e;
        row.W.middleRows<3>(3) = lie::tilde(e_i) * of_y;
        row.W.block<3, 3>(6, 3) = of_e;
        row.W.block<3, 3>(9, 3) = lie::tilde(s_bar_j) * bj.A.transpose() * of_e;
        row.W.block<3, 3>(9, 9) = lie::tilde(s_bar_j) * lie::tilde(e_j);
        const double k = coefficients.stiffness[axis], c = coefficients.damping[axis];
        row.add_to(k * d[axis] + c * row.w.dot(v), k, c, v, out);
    }
}

bool Bushing::is_dissipative() const
{
    return !(coefficients.damping.isZero(0) && coefficients.rotational_damping.isZero(0));
}

namespace {

/// J_r(ψ)⁻¹ = I + ψ̃/2 + c(|ψ|) ψ̃²: c(x) = (1 - x/2 cot(x/2))/x² and c'(x)/x
struct InverseCoefficient {
    double c, cdot;
    explicit InverseCoefficient(double x)
    {
        const double x2 = x * x;
        if (x2 < 0.25) {
            c = 1. / 12 + x2 * (1. / 720 + x2 * (1. / 30240 + x2 * (1. / 1209600 + x2 / 47900160)));
            cdot = 1. / 360 +
                   x2 * (1. / 7560 + x2 * (1. / 201600 + x2 * (1. / 5987520 + x2 * (691. / 130767436800))));
        } else {
            const double s = std::sin(x / 2), cot = std::cos(x / 2) / s;
            c = (1 - x / 2 * cot) / x2;
            cdot = ((x / (4 * s * s) - cot / 2) / x2 - 2 * c / x) / x;
        }
    }
};

}  // namespace

void Bushing::add_rotations(const State& x, LoadDerivatives& out) const
{
    const Motion &bi = motion(x, i), &bj = motion(x, j);
    const Vec3 psi = deflection(x).psi;
    const Mat3 A_ij = bi.A.transpose() * bj.A, J_inverse = lie::right_jacobian_inverse(psi);
    const Vec12 v = velocities(bi, bj);
    const InverseCoefficient at(psi.norm());
    Eigen::Matrix<double, 3, 12> of_psi = Eigen::Matrix<double, 3, 12>::Zero();
    of_psi.middleCols<3>(3) = -J_inverse * A_ij.transpose();
    of_psi.rightCols<3>() = J_inverse;
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3 e = Vec3::Unit(axis), of_j = J_inverse.row(axis), of_i = A_ij * of_j;
        RowLoad row;
        row.w << Vec3::Zero(), -of_i, Vec3::Zero(), of_j;
        row.g = row.w;
        // J_r(ψ)⁻ᵀ e = e - ψ × e/2 + c ψ × (ψ × e)
        const Vec3 cross = psi.cross(e), twice = psi.cross(cross);
        const Mat3 by_psi = 0.5 * lie::tilde(e) -
                            at.c * (lie::tilde(cross) + lie::tilde(psi) * lie::tilde(e)) +
                            at.cdot * twice * psi.transpose();
        const Eigen::Matrix<double, 3, 12> of_row = by_psi * of_psi;
        row.W.bottomRows<3>() = of_row;
        row.W.middleRows<3>(3) = -A_ij * of_row;
        row.W.block<3, 3>(3, 3) -= lie::tilde(of_i);
        row.W.block<3, 3>(3, 9) += A_ij * lie::tilde(of_j);
        const double k = coefficients.rotational_stiffness[axis], c = coefficients.rotational_damping[axis];
        row.add_to(k * psi[axis] + c * row.w.dot(v), k, c, v, out);
    }
}

double Bushing::potential_energy(const State& x) const
{
    const Deflection at = deflection(x);
    return 0.5 * (at.d.dot(coefficients.stiffness.cwiseProduct(at.d)) +
                  at.psi.dot(coefficients.rotational_stiffness.cwiseProduct(at.psi)));
}

std::vector<Quantity> Bushing::quantities() const
{
    std::vector<Quantity> all;
    for (const char* axis : {"x", "y", "z"})
        all.push_back({std::string("d") + axis, "m", "vector from P to Q, frame of body i"});
    for (const char* axis : {"x", "y", "z"})
        all.push_back({std::string("psi_") + axis, "rad",
                       "rotation vector of body j relative to body i since the start, frame of body j"});
    return all;
}

void Bushing::values(const State& x, double* out) const
{
    const Deflection at = deflection(x);
    Vec3::Map(out) = at.d, Vec3::Map(out + 3) = at.psi;
}

namespace {

const TypeSchema schema_bushing = {
    .description =
        "Bushing: a linear spring and damper with three translational and three rotational components. The "
        "deflection is the vector from P to Q and the rotation vector of body j relative to body i since "
        "the start, in the frame of body i and of body j at the start. The run stops with an error at a "
        "relative rotation of 3 rad.",
    .examples = {R"("body_i": "ground", "body_j": "rod", "stiffness": [1e5, 1e5, 1e4], )"
                 R"("rotational_stiffness": [50, 50, 5])"}};

Vec3 not_negative(ObjectReader& o, const char* key, About about, const std::optional<Vec3>& fallback = {})
{
    about.rest = R"("$ref": "#/$defs/coefficients")";
    Vec3 k = o.vec3(key, about, fallback);
    if (!(k.minCoeff() >= 0))
        o.fail(key, std::string(key) + " must not have negative components, got " + described(*o.find(key)));
    return k;
}

const bool registered_bushing = io::Registry<ForceType>::add(
    {.name = "bushing",
     .schema = schema_bushing,
     .read = [](ObjectReader& o, const BodyFinder& bodies, const State& x) -> std::unique_ptr<Force> {
         const auto [i, j] = bodies.pair(o);
         const Points s(o);
         Bushing::Coefficients c;
         c.stiffness =
             not_negative(o, "stiffness", {"Stiffness along the axes of body i [N/m].", "[1e5, 1e5, 1e4]"});
         c.damping = not_negative(
             o, "damping", {"Damping coefficients along the axes of body i [N s/m].", "[100, 100, 10]"},
             Vec3::Zero());
         c.rotational_stiffness =
             not_negative(o, "rotational_stiffness",
                          {"Stiffness for the components of the rotation vector [N m/rad].", "[50, 50, 5]"});
         c.rotational_damping =
             not_negative(o, "rotational_damping",
                          {"Damping coefficients for the components of the rotation vector [N m s/rad].",
                           "[0.1, 0.1, 0.1]"},
                          Vec3::Zero());
         return std::make_unique<Bushing>(i, s.i, j, s.j, c, x);
     }});

}  // namespace

}  // namespace hilda::dae
