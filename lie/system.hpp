// SPDX-License-Identifier: GPL-3.0-or-later
/// What a constrained mechanical system is to a stepper:
///
///     M r̈ + Φ_rᵀ λ = F,    J̄ ω̄̇ + Π̄ᵀ λ = τ̄ = n̄ - ω̄ × J̄ ω̄,    Φ(r, A, t) = 0           Fang (2022), Eq. 3.4
///
/// Rows may bring unknowns α without mass, and then Φ(r, A, α, t) = 0 and Φ_αᵀ λ = 0 (5.33). The last rows may hold
/// velocities alone, Φ_r ṙ + Π̄ ω̄ = ν, as rolling does: there is no Φ of them. Some of those may give way, as friction does.

#pragma once

#include "lie/state.hpp"

#include <algorithm>
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

    /// Unknowns α_first_alpha … without mass, in which rows first … first + rows - 1 are written and no others; fewer
    /// than these rows.
    struct AlgebraicGroup {
        int first = 0, rows = 0, first_alpha = 0, count = 0;
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 8, 8> D;  ///< ∂Φ/∂α, rows × count
    };

    /// Two rows of velocities, first and first + 1, that give way: with C their derivatives, v = (ṙ, ω̄) and λ their two
    /// multipliers, over a step h that ends with v
    ///
    ///     λ = K (S + h C v) + D C v                             a spring and a dashpot, both of the end of the step
    ///     |λ| ≤ μ N,  N = n · (multipliers of the rows pressing …  pressing + 2);  0 where N is negative
    ///
    /// Where they would be beyond their bound they are p times softer, p λ = K (S + h C v) + D C v: then λ is as long as the
    /// bound, and against what is left of the motion. See GiveWay for p.
    struct Regularised {
        int first = 0, normal_row = 0;  ///< both rows belong to those that open
        bool solved_first = false;      ///< within its bound before those that are not are looked at
        double K = 0, D = 0, mu = 0;    ///< K is 0 where the rows are empty
        Eigen::Vector2d S = Eigen::Vector2d::Zero();
        Vec3 n = Vec3::Zero();
        double p = 1, compliance = 0;  ///< not of the system; with a minus on the diagonal of K

        double mobility(double h) const { return K > 0 ? 1 / (D + h * K) : 0; }  ///< C v/λ where S = 0
    };

    std::vector<int> start{0};
    std::vector<Entry> entry;
    std::vector<AlgebraicGroup> algebraic;
    std::vector<Regularised> regularised;
    int velocity_rows = 0;  ///< how many of the last rows hold velocities alone
    /// Rows that hold nothing in some states, where all their derivatives are zero and so is Φ. Their corrections are then
    /// zero: whoever empties a row sets its multiplier to zero. Ascending.
    std::vector<int> unilateral;

    /// Makes C (h v) - softness (h² λ) = -h K S/(D + h K) of the rows that give way; empties them for h = 0, as there is no time
    /// in which they could resist.
    void regularise(double h)
    {
        for (Regularised& c : regularised) {
            c.compliance = h > 0 ? c.p * c.mobility(h) / h : 0;
            for (int n = start[c.first]; h == 0 && n < start[c.first + 2]; ++n)
                entry[n].r.setZero(), entry[n].pi.setZero();
        }
    }
    bool is_regularised(int k) const
    {
        for (const Regularised& c : regularised)
            if (k == c.first || k == c.first + 1) return true;
        return false;
    }

    /// Whether row k holds nothing in this state; of a group with massless unknowns the last row is asked.
    bool is_inactive(int k) const
    {
        for (int n = start[k]; n < start[k + 1]; ++n)
            if (entry[n].r != Vec3::Zero() || entry[n].pi != Vec3::Zero()) return false;
        const auto group =
            std::lower_bound(algebraic.begin(), algebraic.end(), k,
                             [](const AlgebraicGroup& m, int row) { return m.first + m.rows - 1 < row; });
        return group == algebraic.end() || group->first + group->rows - 1 != k ||
               group->D.bottomRows<1>().isZero(0);
    }

    int rows() const { return static_cast<int>(start.size()) - 1; }
    int position_rows() const { return rows() - velocity_rows; }
    int unknowns() const  ///< without mass
    {
        int sum = 0;
        for (const AlgebraicGroup& group : algebraic) sum += group.count;
        return sum;
    }

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

    /// Φ_αᵀ λ, times a factor, added to q: the massless unknowns one group after the other
    template <class Lambda, class Q>
    void add_algebraic_transpose(double factor, const Lambda& lambda, Q&& q) const
    {
        int at = 0;
        for (const AlgebraicGroup& group : algebraic) {
            for (int c = 0; c < group.count; ++c)
                for (int k = 0; k < group.rows; ++k)
                    q[at + c] += factor * group.D(k, c) * lambda[group.first + k];
            at += group.count;
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

using Mat6 = Eigen::Matrix<double, 6, 6>;

/// The second variation of all rows: how the blocks (Φ_rᵀ, Π̄ᵀ) of row k that belong to one of its bodies change
/// with the position of another. at(k, a, b) is ∂(r, pi of entry a)/∂(δr, δθ of entry b), entries counted
/// from start[k] of the pattern, A ← A exp(δθ̃).
struct SecondVariation {
    explicit SecondVariation(const Rows& pattern)
    {
        for (int k = 0; k < pattern.rows(); ++k) {
            first.push_back(static_cast<int>(block.size()));
            entries.push_back(pattern.start[k + 1] - pattern.start[k]);
            block.resize(block.size() + entries[k] * entries[k], Mat6::Zero());
        }
    }

    Mat6& at(int k, int a, int b) { return block[first[k] + a * entries[k] + b]; }
    const Mat6& at(int k, int a, int b) const { return block[first[k] + a * entries[k] + b]; }

    std::vector<int> first, entries;
    std::vector<Mat6> block;
};

/// How γ of each row changes, by the entries of the pattern: γ' = r · δr + theta · δθ + rdot · δṙ + omega · δω̄
struct GammaVariation {
    struct Entry {
        Vec3 r = Vec3::Zero(), theta = Vec3::Zero(), rdot = Vec3::Zero(), omega = Vec3::Zero();
    };
    explicit GammaVariation(const Rows& pattern) : entry(pattern.entry.size()) {}

    std::vector<Entry> entry;
};

/// How the loads (F, n̄) on one body change with the motion (δr, δθ, δṙ, δω̄) of another, or of itself
struct LoadVariation {
    struct Block {
        int on = 0, by = 0;
        Eigen::Matrix<double, 6, 12> d = Eigen::Matrix<double, 6, 12>::Zero();
    };
    std::vector<Block> block;

    // room for whoever finds it by differences
    State x;
    Loads plus{0}, minus{0};
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
    /// Φ(r, A, α, t), one number a row; 0 of a row that holds velocities
    virtual void phi(const State& x, Eigen::Ref<Eigen::VectorXd> out) const = 0;
    /// Φ_r, Π̄ and Φ_α, into a copy of pattern()
    virtual void variation(const State& x, Rows& out) const = 0;
    /// ν = -∂Φ/∂t: the rows of Φ_r ṙ + Π̄ ω̄ = ν                                                        Eq. 2.8
    virtual void nu(const State& x, Eigen::Ref<Eigen::VectorXd> out) const = 0;
    /// γ: the rows of Φ_r r̈ + Π̄ ω̄̇ + Φ_α α̈ = γ                                                        Eq. 2.9
    virtual void gamma(const State& x, Eigen::Ref<Eigen::VectorXd> out) const = 0;
    /// Sets x.alpha to what belongs to the poses of the bodies, from what it is: for poses that are not quite on the
    /// constraints, such as a stage of a Runge-Kutta step.
    virtual void update_alpha(State& /*x*/) const {}

    /// What the exact Newton matrices are made of; schemes with a frozen matrix do without. As they stand here
    /// they are found by differences, good to about 1e-9 of the size of what is differentiated and not fast.
    virtual void second_variation(const State& x, SecondVariation& out) const;
    /// ∂ν/∂(δr, δθ), into a copy of pattern()
    virtual void nu_variation(const State& x, Rows& out) const;
    virtual void gamma_variation(const State& x, GammaVariation& out) const;
    /// The blocks of the loads' variation, values not used. As it stands here: loads that change with nothing.
    virtual LoadVariation load_pattern() const { return {}; }
    virtual void load_variation(const State& /*x*/, LoadVariation& /*out*/) const {}

    /// Potential energy of the loads that have one [J]
    virtual double potential_energy(const State&) const { return 0; }
    /// Told once per accepted step, so that what the system remembers is updated in `after` (its memory, its
    /// remembered numbers, and the multipliers of rows that change their meaning). As long as a step is tried
    /// they are those of the state before it.
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
