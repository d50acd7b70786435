// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/scenes/free_bodies.hpp"

namespace hilda::contact {

void drift(Motion& body, double h)
{
    body.r += h * body.rdot;
    if (body.omega_bar != Vec3::Zero()) body.A = lie::orthonormalised(body.A * lie::exp(h * body.omega_bar));
}

double kinetic_energy(const std::vector<Inertia>& inertia, const std::vector<Motion>& body)
{
    double T = 0;
    for (size_t b = 0; b < body.size(); ++b) {
        if (inertia[b].moves()) T += 0.5 * inertia[b].m * body[b].rdot.squaredNorm();
        if (inertia[b].turns()) T += 0.5 * body[b].omega_bar.dot(inertia[b].J_bar * body[b].omega_bar);
    }
    return T;
}

}  // namespace hilda::contact
