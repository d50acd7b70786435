// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/tree/articulated_bodies.hpp"

#include <Eigen/LU>

namespace hilda::lie {

using Kind = TreeJoint::Kind;

ArticulatedBodies::ArticulatedBodies(const Mass& mass, const Tree& tree)
    : mass(mass), tree(tree), joint_of(mass.m.size()), work(tree.joint.size())
{
    for (size_t k = 0; k < tree.joint.size(); ++k)
        joint_of[static_cast<size_t>(tree.joint[k].body)] = static_cast<int>(k);
    ground.omega = ground.Q = ground.a = ground.alpha = Vec3::Zero();
}

void ArticulatedBodies::solve(State& x, const Loads& loads, Eigen::VectorXd& qddot)
{
    const int joints = static_cast<int>(tree.joint.size());
    for (int k = 0; k < joints; ++k) set_body(k, x, loads);
    for (int k = joints - 1; k >= 0; --k) eliminate(k);
    int at = 0;
    for (int k = 0; k < joints; ++k) {
        const TreeJoint& joint = tree.joint[k];
        const Work& w = work[k];
        Motion& body = x.body[joint.body];
        accelerate(k, body.A, qddot, at);
        body.rddot = w.a + w.alpha.cross(w.rho) + w.centripetal;
        body.omegadot_bar = body.A.transpose() * w.alpha;
        if (joint.kind == Kind::free) qddot.segment<6>(at) << body.rddot, body.omegadot_bar;
        at += joint.freedoms();
    }
}

/// Sets the geometry, the velocities and the inertia of one body.
void ArticulatedBodies::set_body(int k, const State& x, const Loads& loads)
{
    const TreeJoint& joint = tree.joint[k];
    const Motion& body = x.body[joint.body];
    const Work& before = joint.before < 0 ? ground : work[joint_of[joint.before]];
    Work& w = work[k];
    w.omega = body.A * body.omega_bar;
    w.rho = -(body.A * joint.s_bar_j);
    w.Q = body.r - w.rho;
    w.D = w.Q - before.Q;
    w.centripetal = w.omega.cross(w.omega.cross(w.rho));
    w.c_a = before.omega.cross(before.omega.cross(w.D));
    w.c_alpha = before.omega.cross(w.omega);
    if (joint.kind == Kind::hinge || joint.kind == Kind::slide) w.axis = body.A * joint.F_j.col(2);
    if (joint.kind == Kind::slide) {
        const Motion* from = joint.before < 0 ? nullptr : &x.body[joint.before];
        const Vec3 to_Q = from ? Vec3(w.Q - from->r) : w.Q;
        Vec3 v = body.rdot - w.omega.cross(w.rho) - before.omega.cross(to_Q);
        if (from) v -= from->rdot;
        w.c_a += 2 * before.omega.cross(w.axis) * w.axis.dot(v);
    }
    const double m = mass.m[joint.body];
    const Vec3 tau_bar = loads.tau_bar(joint.body, mass.J_bar[joint.body], body.omega_bar);
    w.A = m * Mat3::Identity();
    w.B = -m * tilde(w.rho);
    w.C = body.A * mass.J_bar[joint.body] * body.A.transpose();
    w.C += m * (w.rho.squaredNorm() * Mat3::Identity() - w.rho * w.rho.transpose());
    w.p_F = m * w.centripetal - loads.F[joint.body];
    w.p_M = w.rho.cross(w.p_F) - body.A * tau_bar;
}

/// Eliminates the freedoms of a joint, and adds what remains to the body before.
void ArticulatedBodies::eliminate(int k)
{
    const TreeJoint& joint = tree.joint[k];
    Work& w = work[k];
    if (joint.kind == Kind::free) return;
    if (joint.kind == Kind::hinge || joint.kind == Kind::slide) {
        double D = 0, u = 0;
        if (joint.kind == Kind::hinge) {
            w.U_F = w.B * w.axis;
            w.U_M = w.C * w.axis;
            D = w.axis.dot(w.U_M);
            u = -w.axis.dot(w.p_M);
        } else {
            w.U_F = w.A * w.axis;
            w.U_M = w.B.transpose() * w.axis;
            D = w.axis.dot(w.U_F);
            u = -w.axis.dot(w.p_F);
        }
        const double by_D = 1 / D;
        w.D_inverse(0, 0) = by_D;
        w.u[0] = u;
        if (joint.before < 0) return;
        const Vec3 U_F = w.U_F * by_D, U_M = w.U_M * by_D;
        w.A -= U_F * w.U_F.transpose();
        w.B -= U_F * w.U_M.transpose();
        w.C -= U_M * w.U_M.transpose();
        w.p_F += w.A * w.c_a + w.B * w.c_alpha + U_F * u;
        w.p_M += w.B.transpose() * w.c_a + w.C * w.c_alpha + U_M * u;
    } else if (joint.kind == Kind::ball) {
        w.D_inverse = w.C.inverse();
        w.u = -w.p_M;
        if (joint.before < 0) return;
        const Mat3 B_by_C = w.B * w.D_inverse;
        w.A -= B_by_C * w.B.transpose();
        w.p_F += w.A * w.c_a + B_by_C * w.u;
    } else {
        if (joint.before < 0) return;
        w.p_F += w.A * w.c_a + w.B * w.c_alpha;
        w.p_M += w.B.transpose() * w.c_a + w.C * w.c_alpha;
    }
    Work& before = work[joint_of[joint.before]];
    const Mat3 D = tilde(w.D);
    before.A += w.A;
    before.p_F += w.p_F;
    if (joint.kind == Kind::ball) {
        const Mat3 AD = w.A * D;
        before.B -= AD;
        before.C -= D * AD;
        before.p_M += w.D.cross(w.p_F);
        return;
    }
    const Mat3 B = w.B - w.A * D;
    before.B += B;
    before.C += w.C - w.B.transpose() * D + D * B;
    before.p_M += w.p_M + w.D.cross(w.p_F);
}

/// Sets the accelerations of the joint and of the body from those of the body before. A: of the body
void ArticulatedBodies::accelerate(int k, const Mat3& A, Eigen::VectorXd& qddot, int at)
{
    const TreeJoint& joint = tree.joint[k];
    Work& w = work[k];
    if (joint.kind == Kind::free) {
        // [ A B ; Bᵀ C ] (a, α) = -p
        const Mat3 C_inverse = w.C.inverse(), B_by_C = w.B * C_inverse;
        w.a = (w.A - B_by_C * w.B.transpose()).inverse() * (B_by_C * w.p_M - w.p_F);
        w.alpha = -(C_inverse * (w.p_M + w.B.transpose() * w.a));
        return;
    }
    const Work& before = joint.before < 0 ? ground : work[joint_of[joint.before]];
    w.a = before.a + before.alpha.cross(w.D) + w.c_a;
    w.alpha = before.alpha + w.c_alpha;
    if (joint.kind == Kind::ball) {
        const Vec3 gamma = w.D_inverse * (w.u - w.B.transpose() * w.a - w.C * w.alpha);
        qddot.segment<3>(at) = A.transpose() * gamma;
        w.alpha += gamma;
    } else if (joint.kind != Kind::fixed) {
        const double of_joint = (w.u[0] - w.U_F.dot(w.a) - w.U_M.dot(w.alpha)) * w.D_inverse(0, 0);
        qddot[at] = of_joint;
        (joint.kind == Kind::hinge ? w.alpha : w.a) += w.axis * of_joint;
    }
}

}  // namespace hilda::lie
