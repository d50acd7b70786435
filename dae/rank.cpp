// SPDX-License-Identifier: GPL-3.0-or-later
/// Rank of the constraint rows by SuiteSparseQR.
#include "dae/rank.hpp"

#include "dae/model.hpp"
#include "lie/solver/elimination.hpp"

#include <SuiteSparseQR.hpp>

#include <algorithm>

namespace hilda::dae {

namespace {

/// The general constraints to which the rows of the reduced system after those of blocks belong. Inactive
/// constraints have no rows there.
std::vector<const Constraint*> constraints_of_rows(const Model& model, const State& x)
{
    std::vector<const Constraint*> of_row;
    for (const bool velocity_level : {false, true})
        for (const auto& c : model.general_constraints()) {
            if (Model::inactive(*c, x)) continue;
            const Constraint::Size size = c->size();
            of_row.insert(of_row.end(),
                          static_cast<size_t>(velocity_level ? size.velocity_rows - 2 * size.bounded_pairs
                                                             : size.position_rows - size.algebraic_variables),
                          c.get());
        }
    return of_row;
}

/// The rows of the reduced system in the order in which they are kept: of dependent rows the last one is
/// redundant. The rows of general constraints other than contacts come first, because only those of blocks
/// are dropped. Those of contacts come last: a contact whose row is redundant changes its mode.
std::vector<int> order_of_rows(int blocks, const std::vector<const Constraint*>& general)
{
    std::vector<int> first, last;
    for (size_t k = 0; k < general.size(); ++k)
        (general[k]->as_contact() == nullptr ? first : last).push_back(blocks + static_cast<int>(k));
    for (int k = 0; k < blocks; ++k) first.push_back(k);
    first.insert(first.end(), last.begin(), last.end());
    return first;
}

}  // namespace

std::vector<int> dependent_rows(const Model& model, State& x, double tolerance)
{
    lie::Rows full_rows = model.pattern();
    model.variation(x, full_rows);
    full_rows.regularise({});  // regularised rows become zero: their multipliers are always determined
    std::vector<char> inactive(full_rows.rows(), 0);
    for (const int k : full_rows.unilateral) inactive[k] = full_rows.is_inactive(k);
    lie::Elimination elimination(full_rows, inactive);  // one row remains of each contact
    elimination.factor(full_rows);
    const lie::Rows& C = elimination.reduced();
    const int m = C.rows(), n = 6 * model.bodies();

    cholmod_common common;
    cholmod_l_start(&common);
    common.print = 0;
    // A column of the matrix A is a row of the constraints, scaled to length one.
    cholmod_triplet* triplets =
        cholmod_l_allocate_triplet(n, m, 6 * C.entry.size(), 0, CHOLMOD_REAL, &common);
    auto* row = static_cast<SuiteSparse_long*>(triplets->i);
    auto* column = static_cast<SuiteSparse_long*>(triplets->j);
    auto* value = static_cast<double*>(triplets->x);
    const int blocks = static_cast<int>(model.active_rows().size());
    const std::vector<const Constraint*> general = constraints_of_rows(model, x);
    const std::vector<int> order = order_of_rows(blocks, general);
    for (int at = 0; at < m; ++at) {
        const int k = order[at];
        double sum = 0;
        const size_t first = triplets->nnz;
        for (int e = C.start[k]; e < C.start[k + 1]; ++e)
            for (int c = 0; c < 6; ++c) {
                const int b = C.entry[e].body;
                const double inertia = c < 3 ? model.mass().m[b] : model.mass().J_bar[b](c - 3, c - 3);
                const double v = (c < 3 ? C.entry[e].r[c] : C.entry[e].pi[c - 3]) / std::sqrt(inertia);
                if (v == 0) continue;
                row[triplets->nnz] = 6 * b + c;
                column[triplets->nnz] = at;
                value[triplets->nnz++] = v;
                sum += v * v;
            }
        for (size_t e = first; e < triplets->nnz; ++e) value[e] /= std::sqrt(sum);
    }
    cholmod_sparse* A = cholmod_l_triplet_to_sparse(triplets, triplets->nnz, &common);
    cholmod_l_free_triplet(&triplets, &common);

    // The columns are not reordered, so that of two equal rows the later one is redundant. R then has echelon
    // form: an independent column has an entry in one more row than the columns before it, a dependent column
    // has not.
    cholmod_sparse* R = nullptr;
    SuiteSparse_long* E = nullptr;
    const SuiteSparse_long rank =
        SuiteSparseQR<double>(SPQR_ORDERING_FIXED, tolerance, 0, A, &R, &E, &common);
    std::vector<int> dependent;
    SuiteSparse_long independent = 0;
    if (rank >= 0 && E == nullptr) {
        const auto* start = static_cast<const SuiteSparse_long*>(R->p);
        const auto* index = static_cast<const SuiteSparse_long*>(R->i);
        for (int k = 0; k < m; ++k) {
            if (std::find(index + start[k], index + start[k + 1], independent) != index + start[k + 1])
                ++independent;
            else
                dependent.push_back(order[k]);
        }
        std::sort(dependent.begin(), dependent.end());
    }

    cholmod_l_free(m, sizeof(SuiteSparse_long), E, &common);
    cholmod_l_free_sparse(&R, &common);
    cholmod_l_free_sparse(&A, &common);
    cholmod_l_finish(&common);
    if (rank < 0 || rank != independent)
        throw lie::SingularMatrix("SuiteSparseQR could not determine the rank of the constraints", 0);
    std::vector<const Constraint*> dependent_contacts;
    while (!dependent.empty() && dependent.back() >= blocks) {
        dependent_contacts.push_back(general[static_cast<size_t>(dependent.back() - blocks)]);
        dependent.pop_back();
    }
    std::reverse(dependent_contacts.begin(), dependent_contacts.end());
    std::vector<std::string> undetermined;
    bool can_keep = true;  // contacts have no redundant rows
    for (const Constraint* c : dependent_contacts)
        if (const ContactConstraint* const contact = c->as_contact();
            contact != nullptr && contact->mode_if_redundant() != Constraint::active)
            Model::set_mode(*contact, x, contact->mode_if_redundant());
        else if (undetermined.empty() || undetermined.back() != c->label()) {
            undetermined.push_back(c->label());
            can_keep = can_keep && contact == nullptr;
        }
    std::string names;
    for (const std::string& label : undetermined) names += (names.empty() ? "" : ", ") + label;
    if (!names.empty())
        throw lie::NumericalFailure(
            "contact_rank",
            "the forces of these constraints are not determined, because other "
            "constraints already prevent the same motion: " +
                names +
                (can_keep ? ". With \"redundant\": \"keep\" in the model file all rows are kept" : ""));
    return dependent;
}

}  // namespace hilda::dae
