// SPDX-License-Identifier: GPL-3.0-or-later
/// contact-lists.csv: the contacts at the times of a case with `contacts`.

#include "granular/running/sink.hpp"
#include "granular/world/contact_output.hpp"

#include <algorithm>

namespace hilda::granular {

namespace {

class ContactLists final : public io::RowsSink<World> {
public:
    explicit ContactLists(const CaseSetup& run) : RowsSink(run.directory, "contact-lists.csv")
    {
        const ContactSpec& spec = *run.c.outputs.contacts;
        if (spec.interval > 0) steps = run.steps_in(spec.interval);
        for (const double t : spec.times) instants.push_back(std::lround(std::min(t / run.c.h, 9e15)));
        std::sort(instants.begin(), instants.end());
    }

    bool takes(long n) const override
    {
        return (steps > 0 && n % steps == 0) || std::binary_search(instants.begin(), instants.end(), n);
    }
    long next(long n) const override
    {
        const long of_interval = steps > 0 ? (n / steps + 1) * steps : std::numeric_limits<long>::max();
        const auto at = std::upper_bound(instants.begin(), instants.end(), n);
        return at == instants.end() ? of_interval : std::min(of_interval, *at);
    }

private:
    std::string header() const override { return contact_list_header(); }
    void append(std::string& text, const World& w) override
    {
        contact_list_csv(text, w.t(), finite_contacts(w));
    }

    long steps = 0;              ///< between lists; 0: at the instants only
    std::vector<long> instants;  ///< [steps], in ascending order
};

const bool registered_contact_lists =
    io::Registry<SinkType>::add({.name = "contact_lists",
                                 .make = [](const CaseSetup& run) -> std::unique_ptr<Sink> {
                                     if (!run.c.outputs.contacts || !run.c.outputs.contacts->has_lists())
                                         return nullptr;
                                     return std::make_unique<ContactLists>(run);
                                 },
                                 .files = {"contact-lists.csv"}});

}  // namespace

}  // namespace hilda::granular
