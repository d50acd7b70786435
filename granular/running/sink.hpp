// SPDX-License-Identifier: GPL-3.0-or-later
/// Sinks of a run of a case. A new output format is one file in granular/running.

#pragma once

#include "granular/case/case_file.hpp"
#include "io/sink.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

/// Instants of samples: `samples` in each interval of `steps` steps, as equally spaced as whole steps allow;
/// the last one is the end of the interval.
struct SampleTimes {
    long steps, samples;

    /// Number of samples in the first n steps of an interval
    long up_to(long n) const { return static_cast<long>(static_cast<__int128>(n) * samples / steps); }
    bool takes(long n) const
    {
        const long in = (n - 1) % steps;
        return n > 0 && up_to(in + 1) > up_to(in);
    }
    /// The first one after n steps
    long next(long n) const
    {
        const long in = n % steps, number = up_to(in) + 1;
        return n - in + static_cast<long>((static_cast<__int128>(number) * steps + samples - 1) / samples);
    }
};

/// What the sinks of a run are made from. The references outlive the sinks.
struct CaseSetup {
    using Node = World;

    const Case& c;
    const std::string& directory;
    const io::SinkOptions& options;

    /// Number of steps in a time between outputs [s], at least 1
    long steps_in(double time) const { return granular::steps_in(time, c.h); }
};

/// Contacts of a world. Throws NotFiniteState if a force is not finite.
inline std::vector<ContactRecord> finite_contacts(const World& w)
{
    std::vector<ContactRecord> all = w.contacts();
    if (std::any_of(all.begin(), all.end(), [](const ContactRecord& c) { return !finite(c.F); }))
        w.check_loads(w.totals());
    return all;
}

using Sink = io::Sink<World>;
using SinkType = io::SinkType<CaseSetup>;

}  // namespace hilda::granular
