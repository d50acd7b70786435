// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/start/static_friction.hpp"

#include "dae/constraints/contact_constraint.hpp"
#include "dae/force.hpp"
#include "dae/forces/spring_limits.hpp"
#include "dae/model.hpp"
#include "lie/solver/saddle.hpp"
#include "lie/steps/accelerations.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace hilda::dae {

namespace {

using Eigen::VectorXd;

// Largest deflection until bodies at rest come to rest, relative to that at the bound
constexpr double slow = 1e-3;
constexpr double converged = 1e-10;  // relative change of the forces and of the multipliers
constexpr int most_rounds = 200;     // each one with a factorisation
constexpr double margin = 1e-8;      // relative to the bound; a force above its bound by less is held

/// A spring of a force, and its state
struct Held {
    int force = 0, number = 0;  ///< number of the force in the model, and of the spring in the force
    const Force* of = nullptr;  ///< the force
    Force::StaticSpring spring;
    bool slips = false;
    Eigen::Vector2d f = Eigen::Vector2d::Zero();  ///< [N], [N m]
    double needed = 0;                            ///< |f| when it began to slip

    double root() const { return std::sqrt(spring.row[0].stiffness); }
};

/// Whether the bodies of a spring are at rest: the spring would stop their motion along its rows with a small
/// part of its bound. The deflection until then is v √(m/K), with the effective mass m of a row.
class AtRest {
public:
    AtRest(const Model& model, const State& x) : model(model), x(x) {}

    void begin_row()
    {
        end_row();
        rate = mobility = 0;
    }
    /// Adds the derivatives (r, pi) of the row for a body that moves.
    void add(int body, const Vec3& r, const Vec3& pi)
    {
        rate += r.dot(x.body[body].rdot) + pi.dot(x.body[body].omega_bar);
        mobility += free_mobility(model.mass(), body, r, pi);
    }
    bool within(double stiffness, double bound)
    {
        end_row();
        rate = 0;
        return bound > 0 && std::sqrt(squared * stiffness) <= slow * bound;
    }

private:
    void end_row()
    {
        if (mobility > 0) squared += rate * rate / mobility;
    }

    const Model& model;
    const State& x;
    double rate = 0, mobility = 0, squared = 0;  ///< squared: m v² of the rows before [J]
};

/// The solution of set_static_friction()
class StaticFriction {
public:
    StaticFriction(const Model& model, lie::Saddle& K, State& x)
        : model(model), K(K), x(x), near(x.derived), given_loads(x.applied_loads), b(K.size())
    {}

    StaticStart solve()
    {
        if (!find()) return {};
        for (int k = 0; k < most_rounds; ++k) {
            const VectorXd before = x.lambda;
            if (!solve_with_loads()) break;
            const double of_f = correct();
            if (of_f > converged || of_multipliers(before) > converged || release()) continue;
            set_deflections();
            return {.slipping = slipping()};
        }
        held.clear();
        set_deflections();
        return {.slipping = {}, .has_converged = false};
    }

private:
    /// Change of the multipliers relative to them and to the friction forces: where no constraint has a load,
    /// multipliers are rounding errors
    double of_multipliers(const VectorXd& before) const
    {
        double size = x.lambda.norm();
        for (const Held& one : held) size = std::max({size, one.f.norm(), one.spring.bound});
        return size > 0 ? (x.lambda - before).norm() / size : 0;
    }

    /// Lists the springs of bodies at rest. Returns false if there are none.
    bool find()
    {
        model.for_forces(x, [&](const Force& force, int n) {
            if (force.max_static_springs() == 0) return;
            read(force);
            for (int k = 0; k < read_springs; ++k)
                if (is_at_rest(force, springs[static_cast<std::size_t>(k)]))
                    held.push_back({.force = n,
                                    .number = k,
                                    .of = &force,
                                    .spring = springs[static_cast<std::size_t>(k)]});
        });
        return !held.empty();
    }

    void read(const Force& force)
    {
        springs.assign(static_cast<std::size_t>(force.max_static_springs()), {});
        read_springs = force.static_springs(x, springs.data());
    }

    /// Calls add(body, r, pi) for the bodies of a row that move.
    template <class Add>
    void for_bodies(const Force& force, const Force::SpringRow& row, Add add) const
    {
        const auto [i, j] = force.bodies();
        if (i != ground) add(i, row.r_i, row.pi_i);
        if (j != ground) add(j, row.r_j, row.pi_j);
    }

    bool is_at_rest(const Force& force, const Force::StaticSpring& spring) const
    {
        AtRest rest(model, x);
        for (int k = 0; k < spring.rows; ++k) {
            rest.begin_row();
            for_bodies(force, spring.row[static_cast<std::size_t>(k)],
                       [&](int body, const Vec3& r, const Vec3& pi) { rest.add(body, r, pi); });
        }
        return rest.within(spring.row[0].stiffness, spring.bound);
    }

    /// Reads the bounds of the springs for the multipliers of x, and limits the forces of those that slip.
    /// Calls with(force, first, last) for the springs of each force.
    template <class With>
    void for_forces(With with)
    {
        model.set_internal_state_at_start(x);
        x.applied_loads = given_loads;
        for (auto from = held.begin(); from != held.end();) {
            const auto to =
                std::find_if(from, held.end(), [&](const Held& one) { return one.force != from->force; });
            const Force& force = *from->of;
            read(force);
            for (auto one = from; one != to; ++one) {
                const bool is_read = one->number < read_springs;  // not for a contact that has opened
                const auto n = static_cast<std::size_t>(one->number);
                one->spring.bound = is_read ? springs[n].bound : 0;
                one->spring.bound_of_slip = is_read ? springs[n].bound_of_slip : 0;
                if (one->slips && one->f.norm() > 0) one->f *= one->spring.bound_of_slip / one->f.norm();
            }
            with(force, from, to);
            from = to;
        }
    }

    /// Solves for the accelerations and multipliers with the forces f as loads, which no bound limits.
    /// Returns false if the multipliers are not finite.
    bool solve_with_loads()
    {
        for_forces([&](const Force& force, auto from, auto to) {
            if (x.applied_loads.empty()) x.applied_loads.assign(6 * x.body.size(), 0);
            for (auto one = from; one != to; ++one)
                for (int k = 0; k < one->spring.rows; ++k)
                    for_bodies(force, one->spring.row[static_cast<std::size_t>(k)],
                               [&](int body, const Vec3& r, const Vec3& pi) {
                                   double* const at =
                                       x.applied_loads.data() + 6 * static_cast<std::ptrdiff_t>(body);
                                   Vec3::Map(at) -= one->f[k] * r, Vec3::Map(at + 3) -= one->f[k] * pi;
                               });
        });
        lie::solve_accelerations(model, K, x);
        return x.lambda.allFinite();
    }

    /// Sets the deflections that belong to the forces f, and solves for the accelerations and multipliers.
    void set_deflections()
    {
        std::vector<Force::StaticForce> forces;
        for_forces([&](const Force& force, auto from, auto to) {
            if (read_springs == 0) return;
            forces.assign(springs.size(), {});
            for (auto one = from; one != to; ++one)
                forces[static_cast<std::size_t>(one->number)] = {.f = one->f, .slips = one->slips};
            force.set_static_forces(x, forces.data());
        });
        lie::solve_accelerations(model, K, x);
    }

    /// Number of rows of the springs that hold
    Eigen::Index rows() const
    {
        Eigen::Index sum = 0;
        for (const Held& one : held) sum += one.slips ? 0 : one.spring.rows;
        return sum;
    }

    /// Calls with(one, k, at) for the rows k of the springs that hold, with their places in the vectors.
    template <class Springs, class With>
    static void for_rows(Springs& held, With with)
    {
        Eigen::Index at = 0;
        for (auto& one : held)
            if (!one.slips)
                for (int k = 0; k < one.spring.rows; ++k) with(one, static_cast<std::size_t>(k), at++);
    }

    /// √K (J a + γ) with the accelerations a of the bodies of x
    VectorXd scaled_accelerations() const
    {
        VectorXd out = VectorXd::Zero(rows());
        for_rows(held, [&](const Held& one, std::size_t k, Eigen::Index at) {
            const Force::SpringRow& row = one.spring.row[k];
            out[at] = row.gamma;
            for_bodies(*one.of, row, [&](int body, const Vec3& r, const Vec3& pi) {
                out[at] += r.dot(x.body[body].rddot) + pi.dot(x.body[body].omegadot_bar);
            });
            out[at] *= one.root();
        });
        return out;
    }

    /// √K J M̂⁻¹ Jᵀ √K g
    VectorXd multiply(const VectorXd& g)
    {
        b.setZero();
        for_rows(held, [&](const Held& one, std::size_t k, Eigen::Index at) {
            for_bodies(*one.of, one.spring.row[k], [&](int body, const Vec3& r, const Vec3& pi) {
                b.segment<3>(6 * body) += one.root() * g[at] * r;
                b.segment<3>(6 * body + 3) += one.root() * g[at] * pi;
            });
        });
        K.solve_in_step(b);
        VectorXd out = VectorXd::Zero(g.size());
        for_rows(held, [&](const Held& one, std::size_t k, Eigen::Index at) {
            for_bodies(*one.of, one.spring.row[k], [&](int body, const Vec3& r, const Vec3& pi) {
                out[at] += one.root() * (r.dot(b.segment<3>(6 * body)) + pi.dot(b.segment<3>(6 * body + 3)));
            });
        });
        return out;
    }

    /// Largest K J M⁻¹ Jᵀ of a row, for free bodies: a bound of that with constraints
    double largest_mobility() const
    {
        double largest = 0;
        for_rows(held, [&](const Held& one, std::size_t k, Eigen::Index) {
            double mobility = 0;
            for_bodies(*one.of, one.spring.row[k], [&](int body, const Vec3& r, const Vec3& pi) {
                mobility += free_mobility(model.mass(), body, r, pi);
            });
            largest = std::max(largest, mobility * one.spring.row[k].stiffness);
        });
        return largest;
    }

    /// The solution g of smallest norm of S g = r with S = √K J M̂⁻¹ Jᵀ √K, or of its least-squares problem:
    /// the part of r along motions that drivers prescribe remains
    VectorXd conjugate_residuals(VectorXd r)
    {
        constexpr double rounding = 1e-14, of_S = 1e-11, null_part = 1e-8;
        const double size = r.norm();
        VectorXd g = VectorXd::Zero(r.size());
        VectorXd p = r, Sr = multiply(r), Sp = Sr;
        const double first = Sr.norm(), scale = of_S * largest_mobility();
        double product = r.dot(Sr);
        for (Eigen::Index n = 0; n < 2 * r.size() + 10 && product > 0 && Sr.norm() > rounding * first &&
                                 Sr.norm() > scale * r.norm();
             ++n) {
            const double alpha = product / Sp.squaredNorm();
            g += alpha * p;
            r -= alpha * Sp;
            Sr = multiply(r);
            const double next = r.dot(Sr);
            p = r + next / product * p;
            Sp = Sr + next / product * Sp;
            product = next;
        }
        // What remains of r is its part r_0 with S r_0 = 0. All directions p have a multiple of it, and g
        // has one.
        if (r.norm() > null_part * size) g -= g.dot(r) / r.squaredNorm() * r;
        return g;
    }

    /// Corrects the forces of the springs that hold. Returns the change relative to all forces and bounds.
    double correct()
    {
        const VectorXd g = conjugate_residuals(scaled_accelerations());
        double all = 0, change = 0;
        for_rows(held, [&](Held& one, std::size_t k, Eigen::Index at) {
            one.f[static_cast<Eigen::Index>(k)] += one.root() * g[at];
            change += g[at] * g[at];
        });
        // In the metric of the elastic energy. Without a load the forces are rounding errors.
        for (const Held& one : held) {
            const double force = std::max(one.f.norm(), one.spring.bound);
            all += force * force / one.spring.row[0].stiffness;
        }
        return all > 0 ? std::sqrt(change / all) : 0;
    }

    /// Lets the springs slip whose forces exceed their bounds. Returns whether there are any.
    bool release()
    {
        bool released = false;
        for (Held& one : held) {
            if (one.slips || one.f.norm() <= (1 + margin) * one.spring.bound) continue;
            one.slips = released = true;
            one.needed = one.f.norm();
        }
        return released;
    }

    std::vector<Slipping> slipping() const
    {
        std::vector<Slipping> all;
        for (const Held& one : held)
            if (one.slips && one.spring.name != nullptr)
                all.push_back({one.force, one.spring.name, one.needed, one.spring.bound});
        return all;
    }

    const Model& model;
    lie::Saddle& K;
    State& x;
    const std::shared_ptr<const lie::DerivedLists> near;  ///< owns the forces of near pairs
    const std::vector<double> given_loads;
    VectorXd b;
    std::vector<Held> held;
    std::vector<Force::StaticSpring> springs;  ///< of the force read last
    int read_springs = 0;
};

/// The bounded pairs of a contact that are at rest, and those of them below their bound
struct PairsAtRest {
    std::array<bool, Constraint::max_velocity_rows / 2> at_rest{}, sticks{};
};

PairsAtRest pairs_at_rest(const Model& model, const ContactConstraint& c, const State& x)
{
    constexpr double at_bound = 1e-4;  // relative; above the tolerance of lie::BoundedRows
    PairsAtRest out;
    const Constraint::Arguments at = model.arguments(c, x);
    std::array<lie::BoundedPair, Constraint::max_velocity_rows / 2> pair;
    c.set_pairs(at, pair.data());
    Constraint::Derivatives C;
    C.set_zero(c);
    c.variation(at, C);
    const double N = pair[0].n.dot(x.lambda.segment<3>(at.row));
    for (int p = 0; p < c.bounded_pairs(); ++p) {
        AtRest rest(model, x);
        for (int k = 0; k < 2; ++k) {
            const int row = c.position_rows() + 2 * p + k;
            rest.begin_row();
            const auto add = [&](int body, const Constraint::Derivatives::BodyRows& rows) {
                if (body != ground)
                    rest.add(body, rows.row(row).head<3>().transpose(), rows.row(row).tail<3>().transpose());
            };
            add(c.i, C.C_i), add(c.j, C.C_j);
        }
        const auto n = static_cast<std::size_t>(p);
        out.at_rest[n] = rest.within(pair[n].K, pair[n].mu * N);
        out.sticks[n] = out.at_rest[n] &&
                        x.lambda.segment<2>(at.velocity_row + 2 * p).norm() < (1 - at_bound) * pair[n].mu * N;
    }
    return out;
}

void set_static_pairs(const Model& model, lie::Saddle& K, State& x)
{
    // The start has given the rows a compliance c, so that C v̇ = γ + c λ. Corrections δ with C δ_v̇ - c
    // δ_λ = -c λ make them rigid.
    constexpr int corrections = 4;
    std::vector<std::pair<const ContactConstraint*, PairsAtRest>> contacts;
    for (const auto& constraint : model.general_constraints())
        if (const ContactConstraint* const c = constraint->as_contact();
            c != nullptr && c->bounded_pairs() > 0 && !Model::inactive(*c, x))
            contacts.emplace_back(c, pairs_at_rest(model, *c, x));
    if (contacts.empty()) return;
    const lie::Rows& rows = K.rows();
    std::vector<char> is_rigid(static_cast<std::size_t>(rows.rows()), 0);
    for (const auto& [c, pairs] : contacts) {
        const auto first = static_cast<std::size_t>(Model::place(*c).velocity_row),
                   count = static_cast<std::size_t>(c->bounded_pairs());
        for (std::size_t p = 0; p < count; ++p)
            is_rigid[first + 2 * p] = is_rigid[first + 2 * p + 1] = pairs.sticks[p] ? 1 : 0;
    }
    VectorXd lambda = x.lambda, b(K.size());
    for (int n = 0; n < corrections; ++n) {
        b.setZero();
        for (std::size_t k = 0; k < rows.compliance.size(); ++k)
            if (const int row = rows.regularised[k]; is_rigid[static_cast<std::size_t>(row)] != 0)
                K.constraint_part(b)[row] = -rows.compliance[k] * lambda[row];
        K.solve_refined(b);
        lambda = K.constraint_part(b);
        x.lambda += lambda;
        for (std::size_t i = 0; i < x.body.size(); ++i) {
            const auto at = static_cast<Eigen::Index>(6 * i);
            x.body[i].rddot += b.segment<3>(at), x.body[i].omegadot_bar += b.segment<3>(at + 3);
        }
    }
    for (const auto& [c, pairs] : contacts)
        c->set_static_pairs(model.arguments(*c, x), pairs.at_rest.data(),
                            x.internal_state.data() + Model::place(*c).internal_state);
}

}  // namespace

StaticStart set_static_friction(const Model& model, lie::Saddle& K, State& x)
{
    StaticStart out = StaticFriction(model, K, x).solve();
    set_static_pairs(model, K, x);  // after it, because it sets all internal states to those of a start
    return out;
}

}  // namespace hilda::dae
