// SPDX-License-Identifier: GPL-3.0-or-later
/// The grid of runs of a study: made, computed concurrently, and selected by benchmark.

#pragma once

#include "io/error.hpp"
#include "run/jobs/pool.hpp"
#include "studies/framework/columns.hpp"
#include "studies/framework/study_context.hpp"

#include <numeric>
#include <type_traits>

namespace hilda::studies {

/// Rows of parameters and results. Run, or a class derived from it, has the parameters benchmark, scheme and
/// step. Row::transfer(io::Archive&) writes or reads the results of a row, so that an interrupted study can
/// be resumed.
template <class Row>
class Sweep : public std::vector<Row> {
public:
    Sweep() = default;
    /// All combinations of benchmark, scheme and step, in this order
    Sweep(const std::vector<Benchmark>& benchmarks, const Schemes& schemes, const std::vector<double>& steps)
    {
        for (const Benchmark& c : benchmarks)
            for (const lie::Scheme* s : schemes)
                for (const double h : steps) add(c, *s, h);
    }

    Row& add(const Benchmark& c, const lie::Scheme& scheme, double h, double rtol = 0)
    {
        Row& row = this->emplace_back();
        row.c = &c, row.scheme = &scheme, row.h = h, row.rtol = rtol;
        return row;
    }

    /// Calls job(row) for each row, on the threads of --jobs. Rows with small steps take longest. They start
    /// first, so that no long run is alone at the end. A numerical failure becomes the status of its row.
    template <class Job>
    void compute(const StudyContext& study, const Job& job, const std::string& label = "")
    {
        std::vector<size_t> queue(this->size());
        std::iota(queue.begin(), queue.end(), 0);
        std::stable_sort(queue.begin(), queue.end(),
                         [&](size_t a, size_t b) { return (*this)[a].h < (*this)[b].h; });
        study.pool(this->size(), label)
            .with_cost([&](long k) { return cost((*this)[queue[k]]); })
            .run([&](long k) { compute_row((*this)[queue[k]], job); },
                 [&](io::Archive& a, long k) { transfer(a, (*this)[queue[k]]); });
    }
    /// The same, one row after the other, for studies that measure time
    template <class Job>
    void compute_in_turn(const StudyContext& study, const Job& job)
    {
        study.pool(this->size(), "", 1)
            .run([&](long k) { compute_row((*this)[k], job); },
                 [&](io::Archive& a, long k) { transfer(a, (*this)[k]); });
    }

    std::vector<const Row*> of(const Benchmark& c) const
    {
        return those(*this, [&](const Row& row) { return row.c == &c; });
    }

private:
    /// Number of steps; of an adaptive run it is not known
    static double cost(const Row& row) { return row.h > 0 && row.rtol == 0 ? row.c->end / row.h : 1; }
    // With the function of a base class a resumed study would have rows without the results of Row.
    static void transfer(io::Archive& a, Row& row)
    {
        static_assert(std::is_same_v<decltype(&Row::transfer), void (Row::*)(io::Archive&)>,
                      "a row of a study has a member function void transfer(io::Archive&) of its own");
        row.transfer(a);
    }
    template <class Job>
    static void compute_row(Row& row, const Job& job)
    {
        try {
            job(row);
        } catch (const io::NumericalFailure& failure) {
            row.status = failure.status, row.message = failure.what();
        }
    }
};

/// The runs of each scheme on each benchmark, in the order of the sweep
template <class Row>
std::vector<std::vector<const Row*>> series_of(const std::vector<Row>& rows)
{
    std::vector<std::vector<const Row*>> all;
    for (const Row& row : rows) {
        if (all.empty() || all.back().front()->c != row.c || all.back().front()->scheme != row.scheme)
            all.emplace_back();
        all.back().push_back(&row);
    }
    return all;
}

}  // namespace hilda::studies
