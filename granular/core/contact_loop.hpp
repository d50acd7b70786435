// SPDX-License-Identifier: GPL-3.0-or-later
/// The loop over contacts: who touches, what the laws answer, what is remembered. One evaluation per pair.

#pragma once

#include "granular/backend/par.hpp"
#include "granular/core/boundary.hpp"
#include "granular/core/pair_law.hpp"
#include "granular/core/particles.hpp"

namespace hilda::granular {

/// What a contact does to its bodies: F on i and -F on j [N]; R M on each of them, with its own radius R and
/// M = -n × F_t [N]
struct alignas(32) Load {
    Four F, M;
};

/// Pairs that may touch before neighbours are looked for again, and what they remember. j is a particle, or a boundary
/// where its highest bit is set.
struct PairView {
    static constexpr std::uint32_t boundary = 0x80000000u;

    const std::uint32_t *i, *j;
    const std::uint8_t* law;  ///< index into the table of laws; nullptr where there is one
    Four* history;            ///< u [m], age [s], negative while it slides; zero where they do not touch
    Four* turning;            ///< psi and spin; nullptr where no law resists turning
    Load* load;
    Four* torque;  ///< of rolling and spin on i [N m]; nullptr with turning
    std::uint8_t* touches;
    std::uint32_t count;
};

struct ParticleView {
    CellGrid grid;
    const Position* position;
    const Four* velocity;  ///< [m/s], radius [m]
    const Four* omega;     ///< [rad/s], 1/m [1/kg]: 0 for what is fixed
    float radius = 0;      ///< of all [m]; 0 where they differ
};

struct LawView {
    const PairLaw* law;
    int laws;
    const Boundary* boundary;
    float h;  ///< [s]
};

/// Loads of all pairs at t_n, and their histories from t_{n-1} to it
void find_loads(par::Cpu, const ParticleView& particles, const PairView& pairs, const LawView& laws);

/// The same on another back end; see loops.hpp.
template <class Backend>
void find_loads(Backend on, const ParticleView& particles, const PairView& pairs, const LawView& laws);

/// Two particles out of whole numbers: the overlap is q/(D + d), with q = D² - d² exact. All in units but for t.
template <class R>
HILDA_HD inline void set_overlap(ContactPoint<R>& t, const R& q, const R& d2, const R& D, const Vec<R>& apart,
                                 const R& metre)
{
    const R d = sqrt(d2);
    t.delta = q / (D + d) * metre;
    t.n = (R(1.f) / d) * apart;
}

template <class R>
HILDA_HD inline void set_masses(ContactPoint<R>& t, R inverse_i, R inverse_j)
{
    t.R_eff = t.R_i * t.R_j / (t.R_i + t.R_j);
    t.m_eff = R(1.f) / (inverse_i + inverse_j);
}

/// Rates of overlap and slip from the velocities of the centres and the turning of the bodies
template <class R>
HILDA_HD inline void set_rates(ContactPoint<R>& t, const Vec<R>& v, const Vec<R>& omega_i,
                               const Vec<R>& omega_j)
{
    const R along = v.dot(t.n);
    t.v_n = -along;
    t.v_t = v - along * t.n - (t.R_i * omega_i + t.R_j * omega_j).cross(t.n);
    t.omega = omega_i - omega_j;
}

/// A particle and a boundary, but for the step; false where they do not touch
HILDA_HD inline bool meet(ContactPoint<float>& t, const CellGrid& grid, const Position& p, const Four& v,
                          const Four& w, const Boundary& b)
{
    const Vec3 r = place(grid, p);
    const Nearest near = nearest(b, r);
    const double delta = v.w - near.distance;
    if (!(delta > 0)) return false;
    const auto narrow = [](const Vec3& a) {
        return Vec<float>{static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
    };
    t.n = narrow(near.n);
    t.delta = static_cast<float>(delta);
    t.R_i = t.R_eff = v.w, t.R_j = 0;
    t.m_eff = 1 / (w.w + b.inverse_mass());
    set_rates(t, narrow(Vec3{v.x, v.y, v.z} - velocity(b, r - near.distance * near.n)),
              Vec<float>{w.x, w.y, w.z}, narrow(b.omega));
    return true;
}

}  // namespace hilda::granular
