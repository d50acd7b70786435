// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/start/derivative_check.hpp"

#include "dae/block.hpp"
#include "dae/constraints/contact_constraint.hpp"
#include "dae/model.hpp"
#include "dae/start/differences.hpp"
#include "lie/system.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace hilda::dae {

namespace {

constexpr double first_step = 2e-3;  // [m, rad, s], the largest of differences
constexpr double later = 0.0123;     // [s] after the start, where formulas of time often have a kink
constexpr double most = 1e-4;        // largest difference, relative to the largest number
constexpr double least = 1e-6;       // a difference that is always accepted [m, rad and per second]
constexpr double of_second = 1e-3;   // the same for second variations, relative
constexpr double of_second_least = 1e-5;
constexpr double of_loads = 1e-2;

/// Compares the functions of one constraint.
class ConstraintCheck {
public:
    ConstraintCheck(const Constraint& c, const Constraint::Arguments& start, std::vector<std::string>& out)
        : c(c), start(start), bi(start.bi), bj(start.bj), out(out), name(c.label())
    {
        // γ is zero at rest.
        for (auto& [body, number] : {std::pair{&bi, c.i}, {&bj, c.j}})
            if (number != ground) {
                body->rdot += Vec3(0.31, -0.23, 0.47);
                body->omega_bar += Vec3(-0.29, 0.53, 0.17);
            }
    }

    void run()
    {
        // A wrong variation makes γ by differences wrong as well.
        if (has_wrong_variation()) return;
        const Constraint::Arguments x = at(bi, bj, t());
        const int rows = c.position_rows() + c.velocity_rows();
        RowValues given(rows);
        c.nu(x, given.data());
        const bool nu_is_wrong =
            is_wrong("nu", given.head(c.position_rows()), [&] { return nu_by_differences(); });
        if (nu_is_wrong) return;
        c.gamma(x, given.data());
        const double h = first_step / std::max({1., bi.rdot.norm(), bi.omega_bar.norm(), bj.rdot.norm(),
                                                bj.omega_bar.norm()});
        const bool gamma_is_wrong = is_wrong("gamma", given, [&] {
            return RowValues(-derivative([&](double s) { return rate_after(s); }, 1, h, "gamma"));
        });
        const auto* const block = dynamic_cast<const Block*>(&c);
        if (block != nullptr && !gamma_is_wrong) check_second_variations(*block, x);
    }

private:
    double t() const { return start.t + later; }

    Constraint::Arguments at(const Motion& i, const Motion& j, double time) const
    {
        return {i,
                j,
                time,
                start.alpha,
                start.internal_state,
                start.mode,
                start.lambda,
                start.row,
                start.velocity_row};
    }

    RowValues phi(const Motion& i, const Motion& j, double time) const
    {
        RowValues all(c.position_rows());
        c.phi(at(i, j, time), all.data());
        return all;
    }

    RowValues nu_by_differences() const
    {
        return -derivative([&](double s) { return phi(bi, bj, t() + s); }, 1, first_step, "nu");
    }

    /// C v - ν after a time s with constant velocities
    RowValues rate_after(double s) const
    {
        const Motion i = after(bi, s), j = after(bj, s);
        const Constraint::Arguments x = at(i, j, t() + s);
        Constraint::Derivatives d;
        d.set_zero(c);
        c.variation(x, d);
        RowValues of_time(c.position_rows() + c.velocity_rows());
        c.nu(x, of_time.data());
        Eigen::Matrix<double, 6, 1> v_i, v_j;
        v_i << i.rdot, i.omega_bar;
        v_j << j.rdot, j.omega_bar;
        return d.C_i * v_i + d.C_j * v_j - of_time;
    }

    bool has_wrong_variation()
    {
        if (c.position_rows() == 0) return false;
        Constraint::Derivatives given;
        given.set_zero(c);
        c.variation(at(bi, bj, t()), given);
        for (int column = 0; column < 12; ++column) {
            if ((column < 6 ? c.i : c.j) == ground) continue;
            const auto displaced = [&](double by) {
                Motion i = bi, j = bj;
                Motion& body = column < 6 ? i : j;
                if (column % 6 < 3)
                    body.r[column % 3] += by;
                else
                    body.A = body.A * lie::exp(by * Vec3::Unit(column % 3));
                return phi(i, j, t());
            };
            const RowValues values =
                (column < 6 ? given.C_i : given.C_j).col(column % 6).head(c.position_rows());
            const std::string where = " (column " + std::to_string(column % 6 + 1) + ")";
            if (is_wrong(
                    column < 6 ? "C_i" : "C_j", values,
                    [&] { return derivative(displaced, 1, first_step, "a variation"); }, where))
                return true;
        }
        return false;
    }

    template <class Differences>
    bool is_wrong(const std::string& what, const RowValues& given, const Differences& differences,
                  const std::string& where = "")
    {
        if (given.size() == 0) return false;
        RowValues by_differences;
        try {
            by_differences = differences();
        } catch (const lie::NumericalFailure&) {
            return false;  // there is nothing to compare with
        }
        Eigen::Index row = 0;
        const double largest = (given - by_differences).cwiseAbs().maxCoeff(&row);
        const double size = std::max(given.cwiseAbs().maxCoeff(), by_differences.cwiseAbs().maxCoeff());
        if (largest <= most * size + least) return false;
        add(what, row, given[row], by_differences[row], where);
        return true;
    }

    void add(const std::string& what, Eigen::Index row, double given, double by_differences,
             const std::string& where)
    {
        std::ostringstream text;
        text << name << ": " << what << " of row " << row + 1 << " is " << given << ", by differences "
             << by_differences << where;
        out.push_back(text.str());
    }

    template <class Matrix>
    void compare_second(const char* what, const Matrix& given, const Matrix& by_differences)
    {
        Eigen::Index row = 0, column = 0;
        const double largest = (given - by_differences).cwiseAbs().maxCoeff(&row, &column);
        const double size = std::max(given.cwiseAbs().maxCoeff(), by_differences.cwiseAbs().maxCoeff());
        if (!(largest <= of_second * size + of_second_least))
            add(what, 0, given(row, column), by_differences(row, column),
                " (entry " + std::to_string(row + 1) + ", " + std::to_string(column + 1) + ")");
    }

    void check_second_variations(const Block& block, const Constraint::Arguments& x)
    {
        try {
            compare_second("second_variation", block.second_variation(x),
                           c.Constraint::second_variation(x, 0));
            const auto one = [](const Variation& v) {
                Eigen::Matrix<double, 12, 1> all;
                all << v.r_i, v.pi_i, v.r_j, v.pi_j;
                return all;
            };
            compare_second("nu_variation", one(block.nu_variation(x)), one(c.Constraint::nu_variation(x, 0)));
            const auto both = [](const GammaDerivatives& g) {
                Eigen::Matrix<double, 24, 1> all;
                all << g.i.r, g.i.theta, g.i.rdot, g.i.omega, g.j.r, g.j.theta, g.j.rdot, g.j.omega;
                return all;
            };
            compare_second("gamma_variation", both(block.gamma_variation(x)),
                           both(c.Constraint::gamma_variation(x, 0)));
        } catch (const lie::NumericalFailure&) {  // there is nothing to compare with
        }
    }

    const Constraint& c;
    const Constraint::Arguments& start;
    Motion bi, bj;
    std::vector<std::string>& out;
    const std::string name;
};

/// x: a state without kinks of the loads; work.x is x.
void check_loads(const Force& force, const State& x, lie::LoadVariation& work, std::vector<std::string>& out)
{
    Force::LoadDerivatives given, by_differences;
    given.setZero();
    if (!force.load_derivatives(x, given)) return;
    difference_loads(force, x, work, by_differences);
    for (int by = 0; by < 2; ++by)
        if (force.bodies()[static_cast<std::size_t>(by)] == ground) {
            given.middleCols<6>(6 * by).setZero(), given.middleCols<6>(12 + 6 * by).setZero();
            given.middleRows<6>(6 * by).setZero();
        }
    Eigen::Index row = 0, column = 0;
    const double largest = (given - by_differences).cwiseAbs().maxCoeff(&row, &column);
    const double size = std::max(given.cwiseAbs().maxCoeff(), by_differences.cwiseAbs().maxCoeff());
    if (largest <= of_loads * size) return;
    std::ostringstream text;
    text << force.label() << ": load_derivatives has " << given(row, column) << " in row " << row + 1
         << " and column " << column + 1 << ", differences of add() have " << by_differences(row, column);
    out.push_back(text.str());
}

/// A state near x with all bodies in motion: where a force has a kink in x, such as a stop that is touched,
/// it has none there
State moved(State x)
{
    constexpr double small = 1e-4;  // [m, rad]
    for (Motion& body : x.body) {
        body.r += small * Vec3(0.9, -0.7, 1.1);
        body.A = body.A * lie::exp(small * Vec3(-0.8, 1.2, 0.6));
        body.rdot += Vec3(0.31, -0.23, 0.47);
        body.omega_bar += Vec3(-0.29, 0.53, 0.17);
    }
    return x;
}

}  // namespace

std::vector<std::string> wrong_derivatives(const Model& model, const lie::State& x)
{
    DerivativeFindings out;
    for (const Model::Row& row : model.all_rows()) {
        const Block& block = row.active_block(x);
        if (!out.is_next(typeid(block))) continue;
        std::vector<std::string> found;
        ConstraintCheck(block, Model::arguments(block, x), found).run();
        for (const std::string& text : found) out.add(model.name_of(row) + text.substr(text.find(": ")));
    }
    for (const auto& c : model.general_constraints()) {
        const Constraint& constraint = *c;
        if (const ContactConstraint* const contact = c->as_contact()) contact->check_derivatives(out);
        if (c->algebraic_variables() == 0 && !Model::inactive(*c, x) && out.is_next(typeid(constraint)))
            ConstraintCheck(*c, model.arguments(*c, x), out.lines).run();
    }
    if (model.forces().empty() && model.near_forces().empty()) return std::move(out.lines);
    lie::LoadVariation work;
    work.plus = work.minus = lie::Loads(model.bodies());
    const State near = work.x = moved(x);
    const auto compare = [&](const Force& force) {
        force.check_derivatives(x, out);
        if (out.is_next(typeid(force))) check_loads(force, near, work, out.lines);
    };
    for (const auto& f : model.forces()) compare(*f);
    const NearForces& groups = model.near_forces();
    for (std::size_t g = 0; g < groups.all_groups().size(); ++g) {
        int pair = 0;  // the first one; it need not be near
        while (!groups.all_groups()[g]->has_pair(pair)) ++pair;
        compare(*groups.force(groups.first_number(g) + pair));
    }
    return std::move(out.lines);
}

}  // namespace hilda::dae
