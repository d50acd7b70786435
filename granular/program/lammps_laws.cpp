// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/program/lammps_laws.hpp"

#include <cmath>

namespace hilda::granular {

namespace {

double tsuji_polynomial(double e)
{
    return 1.2728 + e * (-4.2783 + e * (11.087 + e * (-22.348 + e * (27.467 + e * (-18.022 + e * 4.8218)))));
}

/// The place of a kind of law, or of its entry if the kind has its default
[[noreturn]] void refuse(const io::JsonSource& source, const std::string& pointer, const std::string& what)
{
    source.fail(pointer, what + " has no counterpart in the export to LAMMPS");
}

std::string tangential(const LammpsLaw& law, const std::string& k_t)
{
    if (law.tangential.empty()) return " tangential linear_nohistory 0 0";
    return " tangential " + law.tangential + ' ' + k_t + ' ' + io::shortest(law.gamma_t) + ' ' +
           io::shortest(law.mu);
}

std::string damping_limit(const LammpsLaw& law) { return law.limit_damping ? " limit_damping" : ""; }

}  // namespace

std::string LammpsLaw::of_material(const Material& m) const
{
    return "hertz/material " + io::shortest(m.E) + ' ' + io::shortest(restitution) + ' ' +
           io::shortest(m.nu) + " damping tsuji" + granular::tangential(*this, "NULL") + damping_limit(*this);
}

std::string LammpsLaw::of_stiffness() const
{
    return "hertz " + io::shortest(4 * E_eff / 3) + ' ' + io::shortest(restitution) + " damping tsuji" +
           granular::tangential(*this, io::shortest(k_t)) + damping_limit(*this);
}

double tsuji_argument(double c)
{
    const double alpha = std::sqrt(1.5) * c;
    double low = -1, high = 1.01;  // the polynomial decreases from 89 to below 0
    for (int k = 0; k < 100; ++k) {
        const double middle = (low + high) / 2;
        (tsuji_polynomial(middle) > alpha ? low : high) = middle;
    }
    return (low + high) / 2;
}

LammpsLaw lammps_law(const PairLaw& law, const io::JsonSource& source, const std::string& pointer)
{
    LammpsLaw out;
    law.normal.visit([&]<class Law>(const Law& l) {
        if constexpr (std::is_same_v<Law, Hertz>)
            out.E_eff = static_cast<double>(l.E_eff), out.restitution = tsuji_argument(double(l.c)),
            out.limit_damping = l.clamped != 0;
        else
            refuse(source, pointer + "/normal", std::string("the normal law ") + Law::name);
    });
    law.tangential.visit([&]<class Law>(const Law& l) {
        if constexpr (std::is_same_v<Law, Mindlin> || std::is_same_v<Law, MindlinIncremental>) {
            out.k_t = static_cast<double>(l.spring.k_t), out.mu = static_cast<double>(l.cap.mu_k);
            out.gamma_t = std::sqrt(out.k_t / (2 * out.E_eff));
            out.tangential = "mindlin_rescale/force";
            if (l.cap.mu_s > l.cap.mu_k) refuse(source, pointer + "/mu_s", "mu_s above mu");
            if constexpr (std::is_same_v<Law, Mindlin>) {
                out.tangential = l.rescale != 0 ? "mindlin_rescale" : "mindlin";
                if (l.spring_bound != 0) refuse(source, pointer + "/tangential/spring_bound", "spring_bound");
            }
        } else if constexpr (!std::is_same_v<Law, NoFriction>) {
            refuse(source, pointer + "/tangential", std::string("the tangential law ") + Law::name);
        }
    });
    const auto expect_none = [&](const auto& laws, const char* kind) {
        laws.visit([&]<class Law>(const Law&) {
            if (std::string(Law::name) != "none")
                refuse(source, pointer + '/' + kind, std::string("the ") + kind + " law " + Law::name);
        });
    };
    expect_none(law.rolling, "rolling"), expect_none(law.spin, "spin"), expect_none(law.cohesion, "cohesion");
    return out;
}

}  // namespace hilda::granular
