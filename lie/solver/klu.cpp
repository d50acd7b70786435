// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/solver/klu.hpp"

#include "lie/check.hpp"

#include <klu.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hilda::lie {

namespace {

// Below this reciprocal condition a scaled matrix is singular to working precision, although KLU reports
// success. It is not applied to a matrix without two-sided scaling: its reciprocal condition depends on the
// units.
constexpr double singular_when_scaled = 1e-14;
// New pivots are chosen if the reciprocal condition is below this fraction of its value at the last choice.
constexpr double pivot_loss_limit = 1e-3;
// Up to this number of unknowns the factors of both orderings are compared.
constexpr int most_compared = 2000;

constexpr int amd = 0, colamd = 1;

}  // namespace

/// AMD orders the symmetric pattern, as if the pivots were on the diagonal. The multipliers of constraints
/// have zeros there: a chain of hinges then has factors that grow with the power 2.4 of its length. COLAMD
/// bounds the fill-in for any pivots. Its factors of such a chain grow linearly, and those of most other
/// mechanisms are larger than with AMD.
struct Klu::Library {
    klu_common common{};
    klu_symbolic* orderings[2] = {};   ///< AMD, COLAMD
    klu_symbolic* symbolic = nullptr;  ///< that of `numeric`
    klu_numeric* numeric = nullptr;
    int n = 0, *columns = nullptr, *rows = nullptr;  ///< the pattern

    explicit Library(Scaling scaling)
    {
        klu_defaults(&common);
        common.btf = 0;  // no block triangular form
        common.scale = scaling == Scaling::none ? -1 : 2;
    }
    ~Library() { clear(); }
    /// The analysis of the pattern with an ordering; nullptr if the matrix is singular for all values
    klu_symbolic* analysed(int ordering)
    {
        common.ordering = ordering;
        if (orderings[ordering] == nullptr) orderings[ordering] = klu_analyze(n, columns, rows, &common);
        return orderings[ordering];
    }
    void clear()
    {
        klu_free_numeric(&numeric, &common);
        for (klu_symbolic*& ordering : orderings) klu_free_symbolic(&ordering, &common);
        symbolic = nullptr;
    }
    Library(const Library&) = delete;
    Library& operator=(const Library&) = delete;
};

Klu::Klu(Scaling scaling) : klu(std::make_unique<Library>(scaling)) {}
Klu::~Klu() = default;

void Klu::analyse(std::vector<int> columns, std::vector<int> rows)
{
    column_start = std::move(columns);
    row_index = std::move(rows);
    value.assign(row_index.size(), 0);
    klu->clear();
    have_pivots = false;
    klu->n = size(), klu->columns = column_start.data(), klu->rows = row_index.data();
    // Large matrices are factored with COLAMD only.
    for (const int ordering : {colamd, amd})
        if ((ordering == colamd || size() <= most_compared) && klu->analysed(ordering) == nullptr)
            throw SingularMatrix(
                "the matrix is singular for all values: there are more constraint rows than degrees of "
                "freedom, or a row has no body",
                0);
}

double Klu::operations() const
{
    const klu_symbolic* const symbolic = klu->analysed(amd);
    // the estimate of AMD; -1 if there is none
    return symbolic != nullptr ? std::max(symbolic->est_flops, 0.) : 0;
}

long Klu::entries_of_factors() const
{
    return klu->numeric == nullptr ? 0 : static_cast<long>(klu->numeric->lnz) + klu->numeric->unz;
}

bool Klu::refactor()
{
    if (!have_pivots || klu_refactor(column_start.data(), row_index.data(), value.data(), klu->symbolic,
                                     klu->numeric, &klu->common) == 0)
        return false;
    ++refactor_count;
    klu_rcond(klu->symbolic, klu->numeric, &klu->common);
    rcond = klu->common.rcond;
    return klu->common.status == KLU_OK && rcond > pivot_loss_limit * rcond_of_pivots;  // false for NaN
}

void Klu::factor(const char* what)
{
    for (const double v : value)
        if (!std::isfinite(v)) throw NonFinite(std::string("an entry of ") + what + " is not finite");
    klu_free_numeric(&klu->numeric, &klu->common);
    rcond = 0;
    double operations = 0;
    const auto factor_with = [&](int ordering) {
        klu_symbolic* const symbolic = klu->orderings[ordering];
        klu_numeric* numeric =
            klu_factor(column_start.data(), row_index.data(), value.data(), symbolic, &klu->common);
        const bool is_factored = numeric != nullptr && klu->common.status == KLU_OK;
        if (is_factored) klu_flops(symbolic, numeric, &klu->common);
        if (is_factored && (klu->numeric == nullptr || klu->common.flops < operations)) {
            operations = klu->common.flops;
            std::swap(klu->numeric, numeric);
            klu->symbolic = symbolic;
            klu_rcond(symbolic, klu->numeric, &klu->common);
            rcond = klu->common.rcond;
        }
        klu_free_numeric(&numeric, &klu->common);
    };
    if (size() <= most_compared) factor_with(amd);
    // The estimate of AMD is a lower bound of its operations.
    if (klu->numeric == nullptr || operations > 2 * this->operations()) factor_with(colamd);
    ++full_count;
    have_pivots = rcond > (klu->common.scale < 0 ? singular_when_scaled : 0);
    if (!have_pivots)
        throw SingularMatrix(std::string(what) + " is singular: redundant or singular constraints?", rcond);
    rcond_of_pivots = rcond;
}

void Klu::solve(double* b) const { klu_solve(klu->symbolic, klu->numeric, size(), 1, b, &klu->common); }

}  // namespace hilda::lie
