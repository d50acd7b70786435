// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/friction/friction_pair.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>

namespace hilda::contact {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double longest_lever = 10;  // of rolling, over the size of the smaller body

/// The smaller size of two surfaces, of which a plane has none
double smaller_size(const Shape& i, const Shape& j)
{
    double smaller = infinite;
    for (const Shape* s : {&i, &j})
        if (s->surface->size() > 0) smaller = std::min(smaller, s->surface->size());
    return smaller;
}

/// nᵀ J n and the mean over the tangents
struct Moments {
    double normal, tangential;
};
Moments moments(const Inertia& body, const Mat3& A, const Vec3& n)
{
    if (!body.turns()) return {infinite, infinite};
    const Vec3 n_bar = A.transpose() * n;
    const double normal = n_bar.dot(body.J_bar * n_bar);
    return {normal, 0.5 * (body.J_bar.trace() - normal)};
}

}  // namespace

Mat3 Inertia::J_bar_inverse() const { return turns() ? Mat3(J_bar.inverse()) : Mat3(Mat3::Zero()); }

FrictionPair::FrictionPair(std::string name, Shape i, Shape j, Inertia of_i, Inertia of_j,
                           std::shared_ptr<const FrictionModel> friction)
    : name(std::move(name)), i(std::move(i)), j(std::move(j)), of_i(std::move(of_i)), of_j(std::move(of_j)),
      friction(std::move(friction)), length(smaller_size(this->i, this->j)),
      m(this->friction->fictitious(this->of_i.m, this->of_j.m))
{}

void FrictionPair::rethrow(const lie::NumericalFailure& e) const
{
    throw lie::NumericalFailure(e.status, "contact '" + name + "': " + e.what());
}

void FrictionPair::set_fictitious(ContactState& now, const Motion& bi, const Motion& bj) const
{
    now.m = m;
    now.lever = longest_lever * length;
    const Moments a = moments(of_i, bi.A, now.contact_point.n), b = moments(of_j, bj.A, now.contact_point.n);
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
                       ? follow(history.contact_frame, now.contact_point, i, j, bi, bj, friction->tracking())
                       : no_slip(now.contact_point, now.contact_point.n.unitOrthogonal());
    } catch (const lie::NumericalFailure& e) {
        rethrow(e);
    }
    set_fictitious(now, bi, bj);
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
    history.found = true;
    history.touching = touching;
}

double FrictionPair::stable_step(const ContactState& now, const NormalSupport& normal, const Motion& bi,
                                 const Motion& bj, int contacts_of_i, int contacts_of_j) const
{
    using Mat6 = Eigen::Matrix<double, 6, 6>;
    using Rows = Eigen::Matrix<double, 6, 3>;
    using Vec6 = Eigen::Matrix<double, 6, 1>;
    const Springs springs = friction->springs(now);
    const Vec3 n = now.contact_point.n, u = n.unitOrthogonal(), w = n.cross(u);

    // Rows: sliding along u and w, pressing along n, rolling about u and w, spinning about n
    constexpr int pressing = 2;
    Rows linear = Rows::Zero();
    linear << u.transpose(), w.transpose(), n.transpose(), Mat3::Zero();
    Mat6 W = Mat6::Zero();
    const auto add = [&](const Inertia& body, const Motion& motion, const Vec3& C, int contacts) {
        if (!body.moves()) return;
        const Vec3 s = C - motion.r;
        Rows angular = Rows::Zero();
        angular << s.cross(u).transpose(), s.cross(w).transpose(), s.cross(n).transpose(), u.transpose(),
            w.transpose(), n.transpose();
        const Rows in_body = angular * motion.A;
        W += contacts *
             (linear * linear.transpose() / body.m + in_body * body.J_bar_inverse() * in_body.transpose());
    };
    add(of_i, bi, now.contact_point.C_i, contacts_of_i);
    add(of_j, bj, now.contact_point.C_j, contacts_of_j);
    if (normal.rigid && W(pressing, pressing) > 0) {
        // what friction moves, the force that holds the normal having answered
        const Vec6 answer = W.col(pressing);
        W -= answer * answer.transpose() / answer[pressing];
    }
    Vec6 K, D;
    K << springs.K_slide, springs.K_slide, normal.K, springs.K_roll, springs.K_roll, springs.K_spin;
    D << springs.D_slide, springs.D_slide, normal.D, springs.D_roll, springs.D_roll, springs.D_spin;
    const auto stable = [&](double h) {
        const Vec6 root = (2 * h * D + h * h * K).cwiseSqrt();
        const Mat6 scaled = root.asDiagonal() * W * root.asDiagonal();
        return Eigen::SelfAdjointEigenSolver<Mat6>(scaled, Eigen::EigenvaluesOnly).eigenvalues().maxCoeff() <
               4;
    };
    double lower = 1e-15, upper = 1e6;  // [s]
    if (stable(upper)) return infinite;
    while (upper > lower * (1 + 1e-12)) {
        const double middle = std::sqrt(lower * upper);
        (stable(middle) ? lower : upper) = middle;
    }
    return lower;
}

}  // namespace hilda::contact
