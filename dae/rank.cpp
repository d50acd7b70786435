// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/rank.hpp"

#include "lie/solver/elimination.hpp"

#include <SuiteSparseQR.hpp>

#include <algorithm>

namespace hilda::dae {

namespace {

/// The contact that row k of the reduced rows belongs to, of which those that are open have none
const Constraint& contact_of(const Model& model, const State& x, int k)
{
    int row = static_cast<int>(model.active_rows().size());
    for (const bool of_velocities : {false, true})
        for (const auto& c : model.evolving()) {
            if (Model::inactive(*c, x)) continue;
            const int held = c->is_regularised() ? 0 : c->velocity_rows();
            row += of_velocities ? held : c->rows() - c->unknowns();
            if (k < row) return *c;
        }
    throw std::logic_error("no contact has this row");
}

}  // namespace

std::vector<int> dependent_rows(const Model& model, State& x, double tolerance)
{
    lie::Rows whole = model.pattern();
    model.variation(x, whole);
    whole.regularise(0);  // what gives way leaves nothing undetermined
    std::vector<char> inactive(whole.rows(), 0);
    for (const int k : whole.unilateral) inactive[k] = whole.is_inactive(k);
    lie::Elimination contacts(whole, inactive);  // a contact is the one row that is left of it
    contacts.factor(whole);
    const lie::Rows& C = contacts.reduced();
    const int m = C.rows(), n = 6 * model.bodies();

    cholmod_common common;
    cholmod_l_start(&common);
    common.print = 0;
    // column k of the matrix is row k of the constraints
    cholmod_triplet* triplets =
        cholmod_l_allocate_triplet(n, m, 6 * C.entry.size(), 0, CHOLMOD_REAL, &common);
    auto* row = static_cast<SuiteSparse_long*>(triplets->i);
    auto* column = static_cast<SuiteSparse_long*>(triplets->j);
    auto* value = static_cast<double*>(triplets->x);
    for (int k = 0; k < m; ++k) {
        double sum = 0;
        const size_t first = triplets->nnz;
        for (int e = C.start[k]; e < C.start[k + 1]; ++e)
            for (int c = 0; c < 6; ++c) {
                const int b = C.entry[e].body;
                const double inertia = c < 3 ? model.mass().m[b] : model.mass().J_bar[b](c - 3, c - 3);
                const double v = (c < 3 ? C.entry[e].r[c] : C.entry[e].pi[c - 3]) / std::sqrt(inertia);
                if (v == 0) continue;
                row[triplets->nnz] = 6 * b + c;
                column[triplets->nnz] = k;
                value[triplets->nnz++] = v;
                sum += v * v;
            }
        for (size_t e = first; e < triplets->nnz; ++e) value[e] /= std::sqrt(sum);
    }
    cholmod_sparse* A = cholmod_l_triplet_to_sparse(triplets, triplets->nnz, &common);
    cholmod_l_free_triplet(&triplets, &common);

    // The order is kept, so that of two equal rows the later one is the redundant one. R is then a staircase:
    // a column that brings something new reaches one row further down than those before it, a dependent one
    // does not.
    cholmod_sparse* R = nullptr;
    SuiteSparse_long* E = nullptr;
    const SuiteSparse_long rank =
        SuiteSparseQR<double>(SPQR_ORDERING_FIXED, tolerance, 0, A, &R, &E, &common);
    std::vector<int> dependent;
    SuiteSparse_long steps = 0;
    if (rank >= 0 && E == nullptr) {
        const auto* start = static_cast<const SuiteSparse_long*>(R->p);
        const auto* index = static_cast<const SuiteSparse_long*>(R->i);
        for (int k = 0; k < m; ++k) {
            if (std::find(index + start[k], index + start[k + 1], steps) != index + start[k + 1])
                ++steps;
            else
                dependent.push_back(k);
        }
    }

    cholmod_l_free(m, sizeof(SuiteSparse_long), E, &common);
    cholmod_l_free_sparse(&R, &common);
    cholmod_l_free_sparse(&A, &common);
    cholmod_l_finish(&common);
    if (rank < 0 || rank != steps)
        throw lie::SingularMatrix("SuiteSparseQR found no rank for the constraints", 0);
    std::vector<const Constraint*> contacts_too_many;
    while (!dependent.empty() && dependent.back() >= static_cast<int>(model.active_rows().size())) {
        contacts_too_many.insert(contacts_too_many.begin(), &contact_of(model, x, dependent.back()));
        dependent.pop_back();
    }
    std::string names;
    for (const Constraint* c : contacts_too_many)
        if (c->has_fallback())
            Model::set_mode(*c, x, Constraint::fallback_active);
        else
            names += (names.empty() ? "'" : ", '") + c->name + "'";
    if (!names.empty())
        throw lie::NumericalFailure(
            "contact_rank",
            "contacts press where other constraints hold already, so that their forces "
            "are not determined: " +
                names);
    return dependent;
}

}  // namespace hilda::dae
