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

/// The functions of the library for a scalar. Complex numbers are pairs of double.
template <class Scalar>
struct Functions {
    static constexpr auto factor = &klu_factor;
    static constexpr auto refactor = &klu_refactor;
    static constexpr auto rcond = &klu_rcond;
    static constexpr auto solve = &klu_solve;
    static constexpr auto free_numeric = &klu_free_numeric;
};
template <>
struct Functions<std::complex<double>> {
    static constexpr auto factor = &klu_z_factor;
    static constexpr auto refactor = &klu_z_refactor;
    static constexpr auto rcond = &klu_z_rcond;
    static constexpr auto solve = &klu_z_solve;
    static constexpr auto free_numeric = &klu_z_free_numeric;
};

template <class Scalar>
double* numbers(Scalar* of)
{
    return reinterpret_cast<double*>(of);
}

bool is_finite(double v) { return std::isfinite(v); }
bool is_finite(const std::complex<double>& v) { return std::isfinite(v.real()) && std::isfinite(v.imag()); }

}  // namespace

template <class Scalar>
struct BasicKlu<Scalar>::Library {
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
        Functions<Scalar>::free_numeric(&numeric, &common);
        klu_free_symbolic(&symbolic, &common);
    }
    Library(const Library&) = delete;
    Library& operator=(const Library&) = delete;
};

template <class Scalar>
BasicKlu<Scalar>::BasicKlu(Scaling scaling) : klu(std::make_unique<Library>(scaling))
{}
template <class Scalar>
BasicKlu<Scalar>::~BasicKlu() = default;

template <class Scalar>
void BasicKlu<Scalar>::analyse(std::vector<int> columns, std::vector<int> rows, std::vector<int> order)
{
    column_start = std::move(columns);
    row_index = std::move(rows);
    value.assign(row_index.size(), 0);
    Functions<Scalar>::free_numeric(&klu->numeric, &klu->common);
    have_pivots = false;
    klu_free_symbolic(&klu->symbolic, &klu->common);
    if (order.empty()) {
        klu->symbolic = klu_analyze(size(), column_start.data(), row_index.data(), &klu->common);
    } else {
        klu->common.tol = 0;  // the diagonal entry is the pivot, whatever its size
        klu->symbolic = klu_analyze_given(size(), column_start.data(), row_index.data(), order.data(),
                                          order.data(), &klu->common);
    }
    if (klu->symbolic == nullptr)
        throw SingularMatrix(
            "the matrix is singular for all values: there are more constraint rows than degrees of freedom, "
            "or a "
            "row has no body",
            0);
}

template <class Scalar>
double BasicKlu<Scalar>::operations() const
{
    // the estimate of AMD; -1 if there is none
    return klu->symbolic->est_flops >= 0 ? klu->symbolic->est_flops : 0;
}

template <class Scalar>
bool BasicKlu<Scalar>::refactor()
{
    if (!have_pivots ||
        Functions<Scalar>::refactor(column_start.data(), row_index.data(), numbers(value.data()),
                                    klu->symbolic, klu->numeric, &klu->common) == 0)
        return false;
    ++refactor_count;
    Functions<Scalar>::rcond(klu->symbolic, klu->numeric, &klu->common);
    rcond = klu->common.rcond;
    return klu->common.status == KLU_OK && rcond > pivot_loss_limit * rcond_of_pivots;  // false for NaN
}

template <class Scalar>
void BasicKlu<Scalar>::factor(const char* what)
{
    for (const Scalar& v : value)
        if (!is_finite(v)) throw NonFinite(std::string("an entry of ") + what + " is not finite");
    Functions<Scalar>::free_numeric(&klu->numeric, &klu->common);
    klu->numeric = Functions<Scalar>::factor(column_start.data(), row_index.data(), numbers(value.data()),
                                             klu->symbolic, &klu->common);
    ++full_count;
    rcond = 0;
    if (klu->numeric != nullptr && klu->common.status == KLU_OK) {
        Functions<Scalar>::rcond(klu->symbolic, klu->numeric, &klu->common);
        rcond = klu->common.rcond;
    }
    have_pivots = rcond > (klu->common.scale < 0 ? singular_when_scaled : 0);
    if (!have_pivots)
        throw SingularMatrix(std::string(what) + " is singular: redundant or singular constraints?", rcond);
    rcond_of_pivots = rcond;
}

template <class Scalar>
void BasicKlu<Scalar>::factor_in_order(const char* what)
{
    // The first factorisation determines the pattern of the factors only. All values are those of
    // klu_refactor: klu_factor adds in another order.
    if (!have_pivots) factor(what);
    ++refactor_count;
    const bool success =
        Functions<Scalar>::refactor(column_start.data(), row_index.data(), numbers(value.data()),
                                    klu->symbolic, klu->numeric, &klu->common) != 0;
    if (success) Functions<Scalar>::rcond(klu->symbolic, klu->numeric, &klu->common);
    rcond = success ? klu->common.rcond : 0;
    if (rcond > 0) return;
    for (const Scalar& v : value)
        if (!is_finite(v)) throw NonFinite(std::string("an entry of ") + what + " is not finite");
    throw SingularMatrix(std::string(what) + " is singular: redundant or singular constraints?", rcond);
}

template <class Scalar>
void BasicKlu<Scalar>::solve(Scalar* b) const
{
    Functions<Scalar>::solve(klu->symbolic, klu->numeric, size(), 1, numbers(b), &klu->common);
}

template class BasicKlu<double>;
template class BasicKlu<std::complex<double>>;

}  // namespace hilda::lie
