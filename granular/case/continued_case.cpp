// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/continued_case.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace hilda::granular {

namespace {

struct Entry {
    std::string key, value;
    bool is_stated;
};

/// The intervals of a case, the stated ones first, which is their order in the text
std::vector<Entry> entries(const io::JsonSource& source)
{
    ObjectReader o(source, source.root, "");
    const Intervals all = read_intervals(o, o.positive("step"), o.positive("end"));
    std::vector<Entry> list;
    for (const auto& [key, value] : {std::pair{"interval", all.rows}, {"frame_interval", all.frames}})
        list.push_back({key, io::shortest(value), o.has(key)});
    std::stable_partition(list.begin(), list.end(), [](const Entry& e) { return e.is_stated; });
    return list;
}

void set(io::JsonSource& source, const Entry& e) { source.set('/' + e.key + '=' + e.value); }

}  // namespace

Intervals read_intervals(ObjectReader& o, double h, double end)
{
    const double interval =
        o.positive("interval",
                   {.text = "Time between rows of run.csv [s], rounded to whole steps. By default end/1000.",
                    .example = "0.002",
                    .computed = true},
                   end / 1000);
    // a whole number of rows, which are a whole number of steps apart
    const double row = h * std::max(1., std::round(interval / h)),
                 long_interval = row * std::max(1., std::round(end / 100 / row));
    return {interval, o.positive("frame_interval",
                                 {.text = "Time between frames for ParaView [s], rounded to whole steps. By "
                                          "default end/100, rounded to whole rows.",
                                  .example = "0.01",
                                  .computed = true},
                                 long_interval)};
}

double end_of(const io::JsonSource& source) { return ObjectReader(source, source.root, "").positive("end"); }

void keep_intervals(io::JsonSource& source, const io::JsonSource& run)
{
    // the default of the interval of the frames follows from both
    const io::Json::Member *const now = source.root.member("interval"), *before = run.root.member("interval");
    const bool same_interval =
        now == nullptr || (before != nullptr && io::written(now->value) == io::written(before->value));
    const bool same_end = end_of(source) == end_of(run) && same_interval;
    const std::size_t changes = source.changes.size();
    for (const Entry& of_run : entries(run))
        if (source.root.member(of_run.key) == nullptr && (of_run.is_stated || !same_end)) set(source, of_run);
    source.changes.resize(changes);  // they are not changes by the user
}

std::string identity(io::JsonSource source)
{
    for (const Entry& e : entries(source))
        if (!e.is_stated) set(source, e);
    source.set("/end=1");
    source.remove(key_without_effect);
    return source.current_text();
}

}  // namespace hilda::granular
