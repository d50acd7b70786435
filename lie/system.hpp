// SPDX-License-Identifier: GPL-3.0-or-later
/// What a constrained mechanical system is to a stepper:
///
///     M r̈ + Φ_rᵀ λ = F,    J̄ ω̄̇ + Π̄ᵀ λ = τ̄ = n̄ - ω̄ × J̄ ω̄,    Φ(r, A, t) = 0           Fang (2022), Eq. 3.4

#pragma once

#include "lie/state.hpp"

#include <string>

namespace hilda::lie {

struct Mass {
    std::vector<double> m;    ///< [kg], positive
    std::vector<Mat3> J_bar;  ///< [kg m²], body frame, about the centre of mass; symmetric positive definite
};

struct Loads {
    std::vector<Vec3> F;      ///< [N], global frame, at the centre of mass
    std::vector<Vec3> n_bar;  ///< [N m], body frame, without the gyroscopic term

    explicit Loads(int bodies) : F(bodies, Vec3::Zero()), n_bar(bodies, Vec3::Zero()) {}
    void set_zero()
    {
        for (Vec3& f : F) f.setZero();
        for (Vec3& n : n_bar) n.setZero();
    }
};

/// The first variation δΦ = Φ_r δr + Π̄ δπ̄ of all rows, by blocks: row k has the entries start[k] …
/// start[k+1]-1, each with the six derivatives for one body. The pattern (start, body, nonzero) is fixed, the
/// values change.
struct Rows {
    struct Entry {
        int body = 0;
        unsigned nonzero = 0b111111;  ///< bit c is clear where component c of (r, pi) is zero in every state
        Vec3 r = Vec3::Zero();        ///< ∂Φ_k/∂r of the body
        Vec3 pi = Vec3::Zero();       ///< Π̄ of row k, for the body
    };

    std::vector<int> start{0};
    std::vector<Entry> entry;

    int rows() const { return static_cast<int>(start.size()) - 1; }

    /// Blocks (Φ_rᵀ λ, Π̄ᵀ λ), times a factor, added to q: six numbers a body.
    template <class Lambda, class Q>
    void add_transpose(double factor, const Lambda& lambda, Q& q) const
    {
        for (int k = 0; k < rows(); ++k) {
            const double l = factor * lambda[k];
            for (int n = start[k]; n < start[k + 1]; ++n) {
                q.template segment<3>(6 * entry[n].body) += l * entry[n].r;
                q.template segment<3>(6 * entry[n].body + 3) += l * entry[n].pi;
            }
        }
    }

    /// (Φ_r r + Π̄ θ)_k for q = (r, θ), six numbers a body.
    template <class Q>
    double dot(int k, const Q& q) const
    {
        double sum = 0;
        for (int n = start[k]; n < start[k + 1]; ++n)
            sum += entry[n].r.dot(q.template segment<3>(6 * entry[n].body)) +
                   entry[n].pi.dot(q.template segment<3>(6 * entry[n].body + 3));
        return sum;
    }
};

/// A system is constant while it is stepped; all that changes is in State.
class System {
public:
    System() = default;
    System(const System&) = delete;
    System& operator=(const System&) = delete;
    virtual ~System() = default;

    int bodies() const { return static_cast<int>(mass().m.size()); }
    int rows() const { return pattern().rows(); }

    virtual const Mass& mass() const = 0;
    /// The fixed pattern of the constraint rows; the values in it are not used.
    virtual const Rows& pattern() const = 0;

    /// F and n̄ in the state x, written over what is there.
    virtual void loads(const State& x, Loads& out) const = 0;
    /// Φ(r, A, t), one number a row
    virtual void phi(const State& x, Eigen::Ref<Eigen::VectorXd> out) const = 0;
    /// Φ_r and Π̄, into a copy of pattern()
    virtual void variation(const State& x, Rows& out) const = 0;
    /// ν = -∂Φ/∂t: the rows of Φ_r ṙ + Π̄ ω̄ = ν                                                        Eq. 2.8
    virtual void nu(const State& x, Eigen::Ref<Eigen::VectorXd> out) const = 0;
    /// γ: the rows of Φ_r r̈ + Π̄ ω̄̇ = γ                                                                 Eq. 2.9
    virtual void gamma(const State& x, Eigen::Ref<Eigen::VectorXd> out) const = 0;

    /// Potential energy of the loads that have one [J]
    virtual double potential_energy(const State&) const { return 0; }
    /// Told once per accepted step, so that what the system remembers is updated in `after` (its memory, and
    /// the multipliers of rows that change their meaning).
    virtual void accepted(const State& /*before*/, State& /*after*/) const {}
    /// What row k belongs to, for messages: constraint 'crank-rod' row 2; bodies 'crank', 'rod'
    virtual std::string row_name(int k) const { return "constraint row " + std::to_string(k); }
    /// Body b, for messages
    virtual std::string body_name(int b) const { return "body " + std::to_string(b); }
};

/// Kinetic and potential energy [J]
inline double energy(const System& system, const State& x)
{
    double e = system.potential_energy(x);
    for (int b = 0; b < system.bodies(); ++b) {
        const Motion& body = x.body[b];
        e += 0.5 * system.mass().m[b] * body.rdot.squaredNorm() +
             0.5 * body.omega_bar.dot(system.mass().J_bar[b] * body.omega_bar);
    }
    return e;
}

}  // namespace hilda::lie
