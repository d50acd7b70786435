// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/tree/joint_coordinates.hpp"

#include <cmath>

namespace hilda::lie {

using Kind = TreeJoint::Kind;

namespace {

const Motion at_rest;  // the ground

const Motion& motion(const State& x, int body) { return body < 0 ? at_rest : x.body[body]; }

}  // namespace

JointCoordinates::JointCoordinates(const Tree& tree) : tree(tree), origin(tree.joint.size())
{
    for (const TreeJoint& joint : tree.joint) count += joint.freedoms();
}

void JointCoordinates::start(const State& x, Eigen::Ref<Eigen::VectorXd> w, Eigen::Ref<Eigen::VectorXd> wdot)
{
    int at = 0;
    for (size_t k = 0; k < tree.joint.size(); ++k) {
        const TreeJoint& joint = tree.joint[k];
        const Motion &i = motion(x, joint.before), &j = x.body[joint.body];
        Origin& o = origin[k];
        o.A = j.A;
        o.rho = -(j.A * joint.s_bar_j);
        o.d = j.r - o.rho - i.r;
        o.axis = i.A * joint.F_i.col(2);
        const Vec3 omega_i = i.A * i.omega_bar, omega_j = j.A * j.omega_bar;
        const Vec3 alpha_i = i.A * i.omegadot_bar, alpha_j = j.A * j.omegadot_bar;
        if (joint.kind == Kind::hinge) {
            const Mat3 F = i.A * joint.F_i, G = j.A * joint.F_j;
            const double by = joint.F_j.col(2).squaredNorm();
            const double c = F.col(0).dot(G.col(0)) + F.col(1).dot(G.col(1)),
                         s = F.col(1).dot(G.col(0)) - F.col(0).dot(G.col(1)),
                         length = std::sqrt(c * c + s * s);
            o.cosine = c / length, o.sine = s / length;
            w[at] = joint.F_j.col(2).dot(j.omega_bar - j.A.transpose() * omega_i) / by;
            wdot[at] = joint.F_j.col(2).dot(j.omegadot_bar - j.A.transpose() * alpha_i) / by;
        } else if (joint.kind == Kind::slide) {
            // Q - P, its derivatives, and those of q from d = q a
            const Vec3 s_i = i.A * joint.s_bar_i, s_j = -o.rho, a = o.axis;
            const Vec3 d = o.d - s_i;
            const Vec3 ddot = j.rdot + omega_j.cross(s_j) - i.rdot - omega_i.cross(s_i);
            const Vec3 dddot = j.rddot + alpha_j.cross(s_j) + omega_j.cross(omega_j.cross(s_j)) - i.rddot -
                               alpha_i.cross(s_i) - omega_i.cross(omega_i.cross(s_i));
            const double by = a.squaredNorm();
            o.displacement = a.dot(d) / by;
            w[at] = a.dot(ddot) / by;
            wdot[at] = a.dot(dddot - omega_i.cross(omega_i.cross(d))) / by;
        } else if (joint.kind == Kind::ball) {
            o.R = orthonormalised(i.A.transpose() * j.A);
            w.segment<3>(at) = j.omega_bar - j.A.transpose() * omega_i;
            wdot.segment<3>(at) = j.A.transpose() * (alpha_j - alpha_i - omega_i.cross(omega_j));
        } else if (joint.kind == Kind::free) {
            o.r = j.r, o.R = orthonormalised(j.A);
            w.segment<6>(at) << j.rdot, j.omega_bar;
            wdot.segment<6>(at) << j.rddot, j.omegadot_bar;
        }
        at += joint.freedoms();
    }
}

void JointCoordinates::place(const Eigen::Ref<const Eigen::VectorXd>& u,
                             const Eigen::Ref<const Eigen::VectorXd>& w, State& x) const
{
    int at = 0;
    for (size_t k = 0; k < tree.joint.size(); ++k) {
        const TreeJoint& joint = tree.joint[k];
        const Origin& o = origin[k];
        Motion& j = x.body[joint.body];
        if (joint.kind == Kind::free) {
            j.r = o.r + u.segment<3>(at), j.A = o.R * exp(u.segment<3>(at + 3));
            j.rdot = w.segment<3>(at), j.omega_bar = w.segment<3>(at + 3);
            at += 6;
            continue;
        }
        const Motion& i = motion(x, joint.before);
        // The rates are added in the frame of the body: start() then finds them again, without a rounding
        // error of the same sign in each step.
        const Vec3 omega_i = i.A * i.omega_bar;
        Vec3 d = i.A * joint.s_bar_i;  // from r_i to Q
        Vec3 rdot = i.rdot;
        if (joint.kind == Kind::ball) {
            j.A = i.A * (o.R * exp(u.segment<3>(at)));
            j.omega_bar = j.A.transpose() * omega_i + w.segment<3>(at);
        } else {
            Mat3 F = i.A * joint.F_i;
            const Vec3 axis = F.col(2);
            if (joint.kind == Kind::hinge) {
                const double cu = std::cos(u[at]), su = std::sin(u[at]);
                const double c = o.cosine * cu - o.sine * su, s = o.sine * cu + o.cosine * su;
                const Vec3 first = F.col(0);
                F.col(0) = c * first + s * F.col(1);
                F.col(1) = c * F.col(1) - s * first;
            } else if (joint.kind == Kind::slide) {
                d += (o.displacement + u[at]) * axis;
                rdot += w[at] * axis;
            }
            j.A = F * joint.F_j.transpose();
            j.omega_bar = j.A.transpose() * omega_i;
            if (joint.kind == Kind::hinge) j.omega_bar += w[at] * joint.F_j.col(2);
        }
        const Vec3 rho = -(j.A * joint.s_bar_j);
        j.r = i.r + d + rho;
        j.rdot = rdot + omega_i.cross(d) + (j.A * j.omega_bar).cross(rho);
        at += joint.freedoms();
    }
}

void JointCoordinates::set_rates(const Eigen::Ref<const Eigen::VectorXd>& u,
                                 const Eigen::Ref<const Eigen::VectorXd>& w,
                                 Eigen::Ref<Eigen::VectorXd> udot) const
{
    udot = w;
    int at = 0;
    for (const TreeJoint& joint : tree.joint) {
        if (joint.kind == Kind::ball)
            udot.segment<3>(at) = right_jacobian_inverse(u.segment<3>(at)) * w.segment<3>(at);
        if (joint.kind == Kind::free)
            udot.segment<3>(at + 3) = right_jacobian_inverse(u.segment<3>(at + 3)) * w.segment<3>(at + 3);
        at += joint.freedoms();
    }
}

void JointCoordinates::spread(const Eigen::Ref<const Eigen::VectorXd>& du, int first,
                              Eigen::VectorXd& out) const
{
    const auto moved = [&](int body) { return out.segment<3>(12 * body + first); };
    const auto turned = [&](int body) { return out.segment<3>(12 * body + first + 3); };  // global frame
    int at = 0;
    for (size_t k = 0; k < tree.joint.size(); ++k) {
        const TreeJoint& joint = tree.joint[k];
        const Origin& o = origin[k];
        Vec3 r = Vec3::Zero(), theta = Vec3::Zero();
        if (joint.before >= 0) {
            theta = turned(joint.before);
            r = moved(joint.before) + theta.cross(o.d);
        }
        if (joint.kind == Kind::hinge) theta += du[at] * o.axis;
        if (joint.kind == Kind::ball) theta += o.A * du.segment<3>(at);
        if (joint.kind == Kind::slide) r += du[at] * o.axis;
        r += theta.cross(o.rho);
        if (joint.kind == Kind::free) r = du.segment<3>(at), theta = o.A * du.segment<3>(at + 3);
        moved(joint.body) = r;
        turned(joint.body) = theta;
        at += joint.freedoms();
    }
    for (size_t k = 0; k < tree.joint.size(); ++k)
        turned(tree.joint[k].body) = (origin[k].A.transpose() * turned(tree.joint[k].body)).eval();
}

}  // namespace hilda::lie
