// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/scenes/dvi/cone_problem.hpp"

namespace hilda::contact {

void ConeProblem::velocity_change(const std::vector<Vec3>& gamma, std::vector<Velocity>& out) const
{
    out.assign(body.size(), {});  // first D γ: impulses and their moments
    for (size_t c = 0; c < contact.size(); ++c) {
        const ContactPair& at = contact[c];
        const Vec3 on_i = at.frame * gamma[c];
        out[at.i].v += on_i;
        out[at.i].omega += at.s_i.cross(on_i);
        out[at.j].v -= on_i;
        out[at.j].omega -= at.s_j.cross(on_i);
    }
    for (size_t b = 0; b < body.size(); ++b) {
        out[b].v *= body[b].m_inverse;
        out[b].omega = body[b].J_inverse * out[b].omega;
    }
}

void ConeProblem::relative_velocities(const std::vector<Velocity>& v, std::vector<Vec3>& out) const
{
    out.resize(contact.size());
    for (size_t c = 0; c < contact.size(); ++c) {
        const ContactPair& at = contact[c];
        const Velocity &i = v[at.i], &j = v[at.j];
        out[c].noalias() = at.frame.transpose() * (i.v + i.omega.cross(at.s_i) - j.v - j.omega.cross(at.s_j));
    }
}

ConeProblem::Block ConeProblem::block(const ContactPair& c) const
{
    const auto body_block = [&](const Body& b, const Vec3& s) -> Mat3 {
        const Mat3 moment = lie::tilde(s) * c.frame;
        return b.m_inverse * Mat3::Identity() + moment.transpose() * b.J_inverse * moment;
    };
    return {body_block(body[c.i], c.s_i), body_block(body[c.j], c.s_j)};
}

}  // namespace hilda::contact
