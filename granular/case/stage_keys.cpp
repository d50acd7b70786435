// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of an entry of `stages`.
#include "granular/case/stage_keys.hpp"

namespace hilda::granular {

namespace {

RestCondition read_condition(ObjectReader o, double h)
{
    RestCondition c;
    if (o.has("kinetic_energy")) c.kinetic_energy = o.positive("kinetic_energy");
    if (o.has("share")) c.share = o.fraction("share");
    if (!c.kinetic_energy && !c.share) o.fail("one of the keys kinetic_energy and share is required");
    c.from = o.not_negative("from", {}, 0);
    constexpr double default_steps = 100;
    c.interval = o.positive("interval", {}, default_steps * h);
    o.finish();
    return c;
}

/// Names of groups, and regions
std::vector<Selection> read_selections(ObjectReader& o, const std::string& key)
{
    std::vector<Selection> all;
    const io::Json::List& elements = o.list(key, false);
    for (std::size_t k = 0; k < elements.size(); ++k) {
        if (elements[k].string() != nullptr)
            all.push_back({*elements[k].string(), {}});
        else if (elements[k].members() != nullptr)
            all.push_back(read_selection(o.object(key, k)));
        else
            o.fail(key, k, key + " must list names of groups and regions, got " + io::described(elements[k]));
    }
    return all;
}

}  // namespace

StageSpec read_stage(ObjectReader& o, double h)
{
    StageSpec s;
    s.name = o.name("name");
    if (o.has("duration")) s.duration = o.positive("duration");
    if (o.has("end")) s.end = o.positive("end");
    if (s.duration && s.end) o.fail("end", "end must not be given together with duration");
    if (o.has("until")) s.until = read_condition(o.object("until"), h);
    const bool has_limit = s.duration || s.end;
    if (o.has("on_timeout") && !(s.until && has_limit))
        o.fail("on_timeout", "on_timeout is only for a stage with until and a duration or end");
    s.fails = o.one_of("on_timeout", {"warn", "fail"}, {}, "warn") == "fail";
    if (const io::Json* set = o.find("set"); set != nullptr) {
        if (set->members() == nullptr)
            o.fail("set", "set must be an object of JSON pointers and values, got " + io::described(*set));
        for (const io::Json::Member& m : *set->members()) s.set.emplace_back(m.key, m.value);
    }
    if (const io::Json* groups = o.find("groups"); groups != nullptr) {
        ObjectReader names = o.object("groups");
        for (const io::Json::Member& m : *groups->members())
            if (m.key != "note") s.groups.emplace_back(m.key, read_selections(names, m.key));
        o.record("groups", names.finish());
    }
    s.remove = read_selections(o, "remove");
    o.finish();
    return s;
}

}  // namespace hilda::granular
