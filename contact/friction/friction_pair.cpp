// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/friction/friction_pair.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace hilda::contact {

namespace {

constexpr double infinite_mass = std::numeric_limits<double>::infinity();
constexpr double longest_lever = 10;  // upper limit of the lever arm of rolling, relative to the smaller size

/// Moment of inertia about n, nᵀ J n, and the mean over the tangent directions [kg m²]
struct Moments {
    double normal, tangential;
};
Moments moments(const Inertia& body, const Mat3& A, const Vec3& n)
{
    if (!body.turns()) return {infinite_mass, infinite_mass};
    const Vec3 n_bar = A.transpose() * n;
    const double normal = n_bar.dot(body.J_bar * n_bar);
    return {normal, 0.5 * (body.J_bar.trace() - normal)};
}

/// Largest eigenvalue of J̄⁻¹ [1/(kg m²)]
double largest_inverse(const Inertia& body)
{
    if (!body.turns()) return 0;
    return Eigen::SelfAdjointEigenSolver<Mat3>(body.J_bar_inverse(), Eigen::EigenvaluesOnly).eigenvalues()[2];
}

}  // namespace

Mat3 Inertia::J_bar_inverse() const { return turns() ? Mat3(J_bar.inverse()) : Mat3(Mat3::Zero()); }

FrictionPair::FrictionPair(std::string name, Shape i, Shape j, Inertia inertia_i, Inertia inertia_j,
                           std::shared_ptr<const FrictionModel> friction)
    : name(std::move(name)), i(std::move(i)), j(std::move(j)), inertia_i(std::move(inertia_i)),
      inertia_j(std::move(inertia_j)), friction(std::move(friction)),
      smaller_size(contact::smaller_size(this->i, this->j)), j_i(largest_inverse(this->inertia_i)),
      j_j(largest_inverse(this->inertia_j)),
      m(this->friction->fictitious(this->inertia_i.m, this->inertia_j.m))
{}

void FrictionPair::rethrow(const lie::NumericalFailure& e) const
{
    throw lie::NumericalFailure(e.status, "contact '" + name + "': " + e.what());
}

void FrictionPair::set_fictitious_inertia(ContactState& now, const Motion& bi, const Motion& bj) const
{
    now.m = m;
    now.max_lever = longest_lever * smaller_size;
    const Moments a = moments(inertia_i, bi.A, now.contact_point.n),
                  b = moments(inertia_j, bj.A, now.contact_point.n);
    now.I_roll = friction->fictitious(a.tangential, b.tangential);
    now.I_spin = friction->fictitious(a.normal, b.normal);
}

ContactState FrictionPair::contact_state(const ContactPoint& contact_point, double N, const Motion& bi,
                                         const Motion& bj, const ContactHistory& history) const
{
    ContactState now;
    now.contact_point = contact_point;
    now.N = N;
    if (!(now.N > 0)) return now;
    try {
        now.slip = history.touching
                       ? track_contact_point(history.contact_frame, now.contact_point, i, j, bi, bj,
                                             friction->tracking())
                       : zero_displacement(now.contact_point, now.contact_point.n.unitOrthogonal());
    } catch (const lie::NumericalFailure& e) {
        rethrow(e);
    }
    set_fictitious_inertia(now, bi, bj);
    return now;
}

void FrictionPair::advance(const ContactState& now, const Motion& bi, const Motion& bj,
                           ContactHistory& history) const
{
    const bool touching = now.N > 0;
    if (!touching)
        history.deflections = {};
    else if (history.touching)
        friction->advance(now, history.deflections);
    history.contact_frame = contact_frame(
        now.contact_point, touching ? now.slip.u : now.contact_point.n.unitOrthogonal(), bi, bj);
    history.has_points = true;
    history.touching = touching;
}

StaticSprings FrictionPair::static_springs(const ContactState& now) const
{
    StaticSprings all = friction->static_springs(now);
    for (StaticSprings::Spring* spring : {&all.slide, &all.roll, &all.spin}) *spring = *spring * now.share;
    return all;
}

lie::LinearSprings<6> FrictionPair::linear_springs(const ContactState& now, const Springs& springs,
                                                   const NormalSupport& normal, const Motion& bi,
                                                   const Motion& bj, ContactCounts contacts) const
{
    using Rows = Eigen::Matrix<double, 6, 3>;
    const Vec3 n = now.contact_point.n, u = n.unitOrthogonal(), w = n.cross(u);

    constexpr int normal_row = 2;
    Rows linear = Rows::Zero();
    linear << u.transpose(), w.transpose(), n.transpose(), Mat3::Zero();
    lie::LinearSprings<6> of;
    of.W.setZero();
    const auto add = [&](const Inertia& body, const Motion& motion, const Vec3& C, double number) {
        if (!body.moves()) return;
        const Vec3 s = C - motion.r;
        Rows angular = Rows::Zero();
        angular << s.cross(u).transpose(), s.cross(w).transpose(), s.cross(n).transpose(), u.transpose(),
            w.transpose(), n.transpose();
        const Rows in_body = angular * motion.A;
        of.W += number *
                (linear * linear.transpose() / body.m + in_body * body.J_bar_inverse() * in_body.transpose());
    };
    add(inertia_i, bi, now.contact_point.C_i, contacts.of_i);
    add(inertia_j, bj, now.contact_point.C_j, contacts.of_j);
    if (normal.rigid && of.W(normal_row, normal_row) > 0) {
        // eliminate the constrained normal motion: Schur complement
        const lie::LinearSprings<6>::Vector normal_column = of.W.col(normal_row);
        of.W -= normal_column * normal_column.transpose() / normal_column[normal_row];
    }
    of.K << springs.K_slide, springs.K_slide, normal.K, springs.K_roll, springs.K_roll, springs.K_spin;
    of.D << springs.D_slide, springs.D_slide, normal.D, springs.D_roll, springs.D_roll, springs.D_spin;
    return of;
}

bool FrictionPair::is_stable(double h, double damping_factor, const ContactState& now,
                             const NormalSupport& normal, const Motion& bi, const Motion& bj,
                             ContactCounts contacts) const
{
    // An upper limit of the trace of P W: no row of a body is longer than √(1/m + s² j), or √j for a rotation
    const Springs springs = friction->springs(now) * now.share;
    double translations = 0, rotations = 0;
    const auto add = [&](const Inertia& body, double j, const Vec3& s, double number) {
        if (!body.moves()) return;
        translations += number * (1 / body.m + s.squaredNorm() * j);
        rotations += number * j;
    };
    add(inertia_i, j_i, now.contact_point.C_i - bi.r, contacts.of_i);
    add(inertia_j, j_j, now.contact_point.C_j - bj.r, contacts.of_j);
    const auto P = [&](double K, double D) { return 2 * damping_factor * h * D + h * h * K; };
    const double normal_row = normal.rigid ? 0 : P(normal.K, normal.D);
    if ((2 * P(springs.K_slide, springs.D_slide) + normal_row) * translations +
            (2 * P(springs.K_roll, springs.D_roll) + P(springs.K_spin, springs.D_spin)) * rotations <
        4)
        return true;
    return linear_springs(now, springs, normal, bi, bj, contacts).is_stable(h, damping_factor);
}

double FrictionPair::elastic_energy(const ContactState& now, const Wrench& load,
                                    const ContactHistory& history) const
{
    if (!(now.N > 0)) return 0;
    const Vec3 &n = now.slip.n, &u = now.slip.u;
    const Deflections& d = history.deflections;
    return 0.5 * (std::abs(load.F_E.dot(tangent(d.S, n, u))) +
                  std::abs(n.cross(load.T_roll_E).dot(tangent(d.Theta_i, n, u))) +
                  std::abs(n.cross(load.T_roll_E_j).dot(tangent(d.Theta_j, n, u))) +
                  std::abs(load.T_spin_E * d.Psi));
}

double FrictionPair::stable_step(const ContactState& now, const NormalSupport& normal, const Motion& bi,
                                 const Motion& bj, ContactCounts contacts, double damping_factor) const
{
    return linear_springs(now, friction->springs(now) * now.share, normal, bi, bj, contacts)
        .stable_step(damping_factor);
}

}  // namespace hilda::contact
