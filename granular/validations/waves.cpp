// SPDX-License-Identifier: GPL-3.0-or-later
/// What a force on the top of a lattice adds to the forces of its floor (Fang 2022, Figs. 7.9 and 7.10; Goldenberg and
/// Goldhirsch, Nature 435, 188).
///
/// The text gives a stiffness of 30000 mg/R, its author's program 3000 mg/R: the first belongs to a law that scales with
/// √(δ/R), the second to a linear one. Both are here.

#include "granular/validations/lattice.hpp"
#include "granular/validations/validation.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

namespace {

constexpr double judged_below = 100;  ///< mg; 300 mg press the sphere through the layers where nothing rubs

std::string name_of(Stiffness s) { return s == Stiffness::scaled ? "scaled" : "linear"; }

double sum(const std::array<double, lattice::widest>& of)
{
    double all = 0;
    for (const double x : of) all += x;
    return all;
}

/// The shape of what F adds
struct Profile {
    Press of;
    std::array<double, lattice::widest> share;  ///< of F
    double centre, peak,
        at;  ///< at the middle; the largest of the spheres up to 20 from it, and how far that one is
    double total;
    double asymmetry;  ///< largest difference of two sides, over the peak
    double weight;     ///< of the lattice, on the floor before F, over its own
    double balance;    ///< what floor and sides hold of the weight and of F, less 1

    Profile(const Press& of, const Pressed& p) : of(of), share(p.share(of.F))
    {
        const int c = lattice::middle;
        centre = peak = share[c], at = 0, asymmetry = 0;
        for (int k = 1; k <= c; ++k) {
            asymmetry = worse(asymmetry, std::abs(share[c + k] - share[c - k]));
            const double both = (share[c + k] + share[c - k]) / 2;
            if (k <= 20 && both > peak) peak = both, at = k;
        }
        asymmetry /= peak;
        total = sum(share);
        weight = sum(p.before.floor) / lattice::spheres;
        balance = (sum(p.after.floor) + p.after.others + p.after.sides) / (lattice::spheres + of.F) - 1;
    }
};

std::string named(const std::string& what, const Press& of)
{
    return what + ", " + name_of(of.stiffness) + ", mu = " + std::to_string(of.mu).substr(0, 3) +
           ", F = " + std::to_string(std::lround(of.F)) + " mg";
}

std::vector<Press> lattices(bool full)
{
    const std::vector<double> forces =
        full ? std::vector<double>{5, 10, 20, 50, 100, 150} : std::vector<double>{5, 20};
    std::vector<Press> all;
    for (const Stiffness s : {Stiffness::scaled, Stiffness::linear})
        for (const double mu : {0., 0.1, 0.2})
            for (const double F : forces) all.push_back({s, mu, F});
    return all;
}

const Profile& find(const std::vector<Profile>& all, Stiffness s, double mu, double F)
{
    return *std::find_if(all.begin(), all.end(), [&](const Profile& p) {
        return p.of.stiffness == s && p.of.mu == mu && p.of.F == F;
    });
}

std::vector<ValidationCheck> judge(const std::vector<Profile>& all)
{
    std::vector<ValidationCheck> checks;
    double total = 0, weight = 0, asymmetry = 0, balance = 0;
    for (const Profile& p : all) {
        if (p.of.F > judged_below) continue;
        total = worse(total, std::abs(p.total - 1)), weight = worse(weight, std::abs(p.weight - 1));
        asymmetry = worse(asymmetry, p.asymmetry), balance = worse(balance, std::abs(p.balance));
    }
    checks.push_back({"what the floor gains, less F, over F", total, 0, 0.015});
    checks.push_back({"what the floor holds without F, less the weight, over it", weight, 0, 0.002});
    checks.push_back({"floor and sides less weight and F, over them", balance, 0, 2e-4});
    checks.push_back({"asymmetry over the peak", asymmetry, 0, 0.02});
    for (const Stiffness s : {Stiffness::scaled, Stiffness::linear}) {
        const Profile& rough = find(all, s, 0.2, 5);
        checks.push_back({named("distance of the peak from the middle", rough.of), rough.at, 0, 1});
        checks.push_back({named("peak", rough.of), rough.peak, 0.06, 0.07});
        const Profile &smooth = find(all, s, 0, 20), &between = find(all, s, 0.1, 20),
                      &most = find(all, s, 0.2, 20);
        checks.push_back({named("middle", smooth.of), smooth.centre, -1, 0.03});
        checks.push_back({named("distance of the peak from the middle", smooth.of), smooth.at, 5, 7});
        checks.push_back({named("middle, more than without friction", between.of),
                          between.centre - smooth.centre, 1e-3, 1});
        checks.push_back(
            {named("middle, more than at mu = 0.1", most.of), most.centre - between.centre, 1e-3, 1});
    }
    return checks;
}

ValidationResult waves(const ValidationOptions& options)
{
    const std::vector<Press> of = lattices(options.full);
    PressRun run{.h = 5e-5, .device = options.device};  // 2e-5 s changes the shares by 2e-4 at most
    if (!options.full) run.ramp = run.hold = 0.5;
    const std::vector<Pressed> pressed = press(of, run, options.progress);

    ValidationTable study{"study",
                          {"stiffness", "mu", "F", "centre", "peak", "distance", "floor", "sides",
                           "asymmetry", "weight", "kinetic_before", "kinetic_after", "sunk"},
                          {}},
        profiles{"profiles", {"stiffness", "mu", "F", "position", "share", "weight"}, {}};
    std::vector<Profile> all;
    for (std::size_t n = 0; n < of.size(); ++n) {
        const Pressed& now = pressed[n];
        const Profile& p = all.emplace_back(of[n], now);
        const std::string name = name_of(of[n].stiffness);
        study.rows.push_back({name, of[n].mu, of[n].F, p.centre, p.peak, p.at, p.total,
                              (now.after.sides - now.before.sides) / of[n].F, p.asymmetry, p.weight,
                              now.before.kinetic, now.after.kinetic, now.sunk});
        for (int k = 0; k < lattice::widest; ++k)
            profiles.rows.push_back(
                {name, of[n].mu, of[n].F, double(k - lattice::middle), p.share[k], now.before.floor[k]});
    }
    return {.tables = {study, profiles}, .checks = judge(all)};
}

const bool registered =
    register_validation({"waves", "a force on a lattice of spheres, at its floor (Figs. 7.9, 7.10)", waves});

}  // namespace

}  // namespace hilda::granular
