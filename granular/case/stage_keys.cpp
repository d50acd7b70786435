// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of an entry of `stages`.
#include "granular/case/stage_keys.hpp"

namespace hilda::granular {

namespace {

RestCondition read_condition(ObjectReader o, double h)
{
    o.defines("rest_condition", "Rest condition",
              "Bounds of the kinetic energy of all particles. All that are given must be met; at least one "
              "is required.",
              R"("anyOf": [{"required": ["kinetic_energy"]}, {"required": ["share"]}])");
    RestCondition c;
    c.kinetic_energy = o.optional_positive(
        "kinetic_energy", {"Bound of the kinetic energy over the number of particles [J].", "1e-12"});
    if (o.given("share"))
        c.share = o.fraction("share",
                             {"Bound of the kinetic energy over the largest one in the stage [-].", "1e-4"});
    if (!c.kinetic_energy && !c.share) o.fail("one of the keys kinetic_energy and share is required");
    c.from = o.not_negative("from",
                            {"Time after the start of the stage from which the condition is evaluated [s]. "
                             "Particles that start at rest need some time to move.",
                             "0.02"},
                            0);
    constexpr double default_steps = 100;
    c.interval =
        o.positive("interval",
                   {.text = "Time between evaluations [s], rounded to whole steps. By default 100 steps.",
                    .example = "0.001",
                    .computed = true},
                   default_steps * h);
    o.finish();
    return c;
}

/// Schema of a list of names of groups, and regions
constexpr const char* selections =
    R"("type": "array", "items": {"anyOf": [{"type": "string"}, {"$ref": "#/$defs/cut"}]})";

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
    o.defines("stage", "Stage",
              "Part of a run with changes at its start. Without duration, end and until it lasts until the "
              "end of the run.",
              R"("if": {"required": ["on_timeout"]}, "then": {"required": ["until"], )"
              R"("anyOf": [{"required": ["duration"]}, {"required": ["end"]}]})");
    StageSpec s;
    s.name = o.name(
        "name", {"Name in messages and in summary.json. Two stages have different names.", R"("settle")"});
    s.duration = o.optional_positive(
        "duration",
        {"Duration of the stage [s], rounded to whole steps; with until the largest one.", "0.5"});
    s.end = o.optional_positive(
        "end",
        {"Time of the run at which the stage ends [s], in place of duration; with until at the latest.",
         "0.5"});
    o.note_exclusive(std::array<std::string, 2>{"duration", "end"});
    if (s.duration && s.end) o.fail("end", "end must not be given together with duration");
    if (o.has("until"))
        s.until = read_condition(o.object("until",
                                          {"Condition that ends the stage: the particles are at rest.",
                                           R"({"kinetic_energy": 1e-12, "from": 0.01})"},
                                          "rest_condition"),
                                 h);
    const bool has_limit = s.duration || s.end;
    if (o.has("on_timeout") && !(s.until && has_limit))
        o.fail("on_timeout", "on_timeout is only for a stage with until and a duration or end");
    const std::string on_timeout =
        o.one_of("on_timeout", {"warn", "fail"},
                 {"What happens if the condition is not met in time: warn begins the next stage with a "
                  "warning, fail ends the run with exit code 4.",
                  R"("fail")"},
                 "warn");
    s.fails = on_timeout == "fail";
    o.note(
        "set", R"("type": "object", "default": {})",
        {"New values of entries of the case from the start of the stage on: JSON pointers with values. In a "
         "pointer the name of a boundary or of an insertion can stand for its number. Possible are gravity, "
         "r, v, omega, F and T of boundaries, the numbers of laws, and rate, mass_rate, to, v, random_v and "
         "active of insertions. In these formulas t is the time since the start of the stage.",
         R"json({"/boundaries/blade/v": ["0.1*min(t/0.01,1)", 0, 0], "/laws/0/mu": 0.4})json"});
    if (const io::Json* set = o.find("set"); set != nullptr) {
        if (set->members() == nullptr)
            o.fail("set", "set must be an object of JSON pointers and values, got " + io::described(*set));
        for (const io::Json::Member& m : *set->members()) s.set.emplace_back(m.key, m.value);
    }
    o.note("groups",
           R"("type": "object", "default": {}, "additionalProperties": {)" + std::string(selections) + '}',
           {"Particles that are assigned to groups at the start of the stage: names of groups with lists of "
            "names of groups, and regions. One entry after the other is evaluated, and before remove.",
            R"({"upper": [{"type": "half_space", "r": [0, 0, 0.03], "normal": [0, 0, 1]}]})"});
    if (const io::Json* groups = o.find("groups"); groups != nullptr) {
        ObjectReader names = o.object("groups", {}, "groups");
        for (const io::Json::Member& m : *groups->members())
            if (m.key != "note") s.groups.emplace_back(m.key, read_selections(names, m.key));
        o.record("groups", names.finish());
    }
    o.note("remove", std::string(selections) + R"(, "default": [])",
           {"Particles that are removed at the start of the stage: names of groups, and regions.",
            R"(["lid"], [{"type": "half_space", "r": [0, 0, 0.03], "normal": [0, 0, 1]}])"});
    s.remove = read_selections(o, "remove");
    o.finish();
    return s;
}

}  // namespace hilda::granular
