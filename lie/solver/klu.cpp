// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/solver/klu.hpp"

#include "lie/check.hpp"

#include <klu.h>

#include <cmath>

namespace hilda::lie {

namespace {

// Below this reciprocal condition a scaled matrix is singular to working precision, although KLU reports
// success. It is not applied to a matrix without two-sided scaling: its reciprocal condition depends on the
// units.
constexpr double singular_when_scaled = 1e-14;
// New pivots are chosen if the reciprocal condition is below this fraction of its value at the last choice.
constexpr double pivot_loss_limit = 1e-3;

}  // namespace

struct Klu::Library {
    klu_common common{};
    klu_symbolic* symbolic = nullptr;
    klu_numeric* numeric = nullptr;

    explicit Library(Scaling scaling)
    {
        klu_defaults(&common);
        common.ordering = 0;  // AMD, for a symmetric pattern
        common.btf = 0;       // no block triangular form
        common.scale = scaling == Scaling::none ? -1 : 2;
    }
    ~Library()
    {
        klu_free_numeric(&numeric, &common);
        klu_free_symbolic(&symbolic, &common);
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
    klu_free_numeric(&klu->numeric, &klu->common);
    have_pivots = false;
    klu_free_symbolic(&klu->symbolic, &klu->common);
    klu->symbolic = klu_analyze(size(), column_start.data(), row_index.data(), &klu->common);
    if (klu->symbolic == nullptr)
        throw SingularMatrix(
            "the matrix is singular for all values: there are more constraint rows than degrees of freedom, "
            "or a "
            "row has no body",
            0);
}

double Klu::operations() const
{
    // the estimate of AMD; -1 if there is none
    return klu->symbolic->est_flops >= 0 ? klu->symbolic->est_flops : 0;
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
    klu->numeric =
        klu_factor(column_start.data(), row_index.data(), value.data(), klu->symbolic, &klu->common);
    ++full_count;
    rcond = 0;
    if (klu->numeric != nullptr && klu->common.status == KLU_OK) {
        klu_rcond(klu->symbolic, klu->numeric, &klu->common);
        rcond = klu->common.rcond;
    }
    have_pivots = rcond > (klu->common.scale < 0 ? singular_when_scaled : 0);
    if (!have_pivots)
        throw SingularMatrix(std::string(what) + " is singular: redundant or singular constraints?", rcond);
    rcond_of_pivots = rcond;
}

void Klu::solve(double* b) const { klu_solve(klu->symbolic, klu->numeric, size(), 1, b, &klu->common); }

}  // namespace hilda::lie
