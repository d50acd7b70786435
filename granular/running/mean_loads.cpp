// SPDX-License-Identifier: GPL-3.0-or-later
/// loads.csv: mean and standard deviation over time of the loads on boundaries, of a case with `loads`.

#include "granular/running/sink.hpp"
#include "io/message.hpp"

#include <cmath>

namespace hilda::granular {

namespace {

class MeanLoads final : public io::RowsSink<World> {
public:
    explicit MeanLoads(const CaseSetup& run)
        : RowsSink(run.directory, "loads.csv"),
          boundaries(run.c.boundaries), times{run.steps_in(run.c.outputs.loads->interval),
                                              run.c.outputs.loads->samples},
          sums(6 * boundaries.size())
    {}

    bool takes(long n) const override { return times.takes(n); }
    long next(long n) const override { return times.next(n); }
    void node(const World& w) override
    {
        const World::Totals totals = w.totals();
        w.check_loads(totals);
        ++count;
        for (std::size_t b = 0; b < boundaries.size(); ++b) {
            const Wrench& on = totals.on_boundary[b];
            const double loads[] = {on.F.x, on.F.y, on.F.z, on.T.x, on.T.y, on.T.z};
            for (std::size_t k = 0; k < 6; ++k) sums[6 * b + k].add(loads[k], count);
        }
        if (count < times.samples) return;
        RowsSink::node(w);
        sums.assign(sums.size(), {});
        count = 0;
    }
    void transfer(io::Archive& a) override
    {
        RowsSink::transfer(a);
        const std::size_t n = sums.size();
        a.value(count), a.list(sums);
        a.check(sums.size() == n && count >= 0 && count < times.samples, "wrong number of samples of loads");
        a.check(std::all_of(sums.begin(), sums.end(),
                            [](const Sum& s) { return std::isfinite(s.mean) && s.squares >= 0; }),
                "the mean loads are wrong");
    }

private:
    /// Mean and sum of the squares of the deviations from it, by Welford's recurrence
    struct Sum {
        double mean = 0, squares = 0;

        void add(double x, long count)
        {
            const double before = x - mean;
            mean += before / static_cast<double>(count);
            squares += before * (x - mean);
        }
    };

    std::string header() const override
    {
        std::string names = "t";
        for (const std::string& b : boundaries)
            for (const char* of : {"mean", "std"})
                for (const char* load : {"_Fx_", "_Fy_", "_Fz_", "_Tx_", "_Ty_", "_Tz_"})
                    names += ',' + b + load + of;
        return names + '\n';
    }
    void append(std::string& text, const World& w) override
    {
        text += io::formatted("%.12g", w.t());
        for (std::size_t b = 0; b < boundaries.size(); ++b) {
            for (std::size_t k = 0; k < 6; ++k) text += io::formatted(",%.9g", sums[6 * b + k].mean);
            for (std::size_t k = 0; k < 6; ++k)
                text += io::formatted(
                    ",%.9g", std::sqrt(sums[6 * b + k].squares / static_cast<double>(times.samples)));
        }
        text += '\n';
    }

    const std::vector<std::string>& boundaries;
    const SampleTimes times;
    std::vector<Sum> sums;
    long count = 0;  ///< samples in sums
};

const bool registered_mean_loads =
    io::Registry<SinkType>::add({.name = "loads",
                                 .make = [](const CaseSetup& run) -> std::unique_ptr<Sink> {
                                     if (!run.c.outputs.loads) return nullptr;
                                     return std::make_unique<MeanLoads>(run);
                                 },
                                 .files = {"loads.csv"}});

}  // namespace

}  // namespace hilda::granular
