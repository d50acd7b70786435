// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/contact_rows.hpp"

namespace hilda::studies {

std::vector<const contact::EvolvingContact*> evolving_contacts(const dae::Model& model)
{
    std::vector<const contact::EvolvingContact*> all;
    for (const auto& c : model.evolving())
        if (const auto* contact = dynamic_cast<const contact::EvolvingContact*>(c.get()))
            all.push_back(contact);
    return all;
}

contact::EvolvingContact::Multipliers forces(const dae::Model& model, const contact::EvolvingContact& c,
                                             const lie::State& x)
{
    if (!dae::Model::open(c, x)) return c.multipliers(model.at(c, x), x.lambda);
    contact::EvolvingContact::Multipliers none;
    none.Psi.setZero(), none.tangential.setZero(), none.friction.setZero();
    none.N.setZero(), none.G.setZero(), none.rolling.setZero();
    none.F_N = 0;
    return none;
}

double largest_residual(const dae::Model& model, const lie::State& x)
{
    double largest = model.largest_residual(x).value;
    double Phi[8];  // the most rows that a constraint may have
    for (const auto& c : model.evolving()) {
        if (dae::Model::open(*c, x)) continue;
        c->phi(model.at(*c, x), Phi);
        for (int k = 0; k < c->rows(); ++k)
            if (!(std::abs(Phi[k]) <= largest)) largest = std::abs(Phi[k]);
    }
    return largest;
}

int contact_rank(const dae::Model& model)
{
    int rank = 0;
    for (const auto& c : model.evolving()) rank += c->rows() + c->velocity_rows() - c->unknowns();
    return rank;
}

}  // namespace hilda::studies
