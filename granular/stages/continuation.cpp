// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/stages/continuation.hpp"

#include "granular/case/continued_case.hpp"
#include "granular/stages/case_changes.hpp"
#include "granular/stages/stages.hpp"
#include "io/archive.hpp"
#include "io/files.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>

namespace hilda::granular {

namespace {

constexpr std::size_t most_of_case = std::size_t{1} << 28;
constexpr const char* name_of_given = "/case-given.json";

bool exists(const std::string& file)
{
    std::error_code error;
    return std::filesystem::exists(file, error);
}

std::string canonical(const std::string& text, const std::string& file)
{
    return io::written(io::JsonSource(text, file).root);
}

io::JsonSource identity_of(const io::JsonSource& source)
{
    return io::JsonSource(identity(source), "", most_of_case);
}

/// Reads the stages of a case that is ready to run otherwise.
void add_stages(Case& c, const Environment& environment)
{
    if (c.stage_specs.empty()) return;
    c.stages = std::make_shared<Stages>(c, environment);
    for (const int b : c.stages->moving()) c.moving.push_back(b);
    std::sort(c.moving.begin(), c.moving.end());
    c.moving.erase(std::unique(c.moving.begin(), c.moving.end()), c.moving.end());
}

/// Throws io::IoError for the first change that is not possible.
void check_possible(const std::vector<CaseChange>& changes, const std::string& directory, bool has_stages)
{
    const ChangeIn where = has_stages ? ChangeIn::resumed_stages : ChangeIn::resumed_run;
    for (const CaseChange& change : changes)
        if (!change.is_possible(where))
            throw io::IoError("--resume: " + directory +
                              "/case.json: is another case, or this case with other options; --force "
                              "overwrites it; " +
                              change.text() + "; " + changeable_entries(where));
}

/// The case of `first` with the outputs of `changed` and its parameters `to`
Case merged(Case first, const Case& changed, const CaseParameters& to)
{
    const io::JsonSource before = identity_of(first.source), now = identity_of(changed.source);
    std::vector<std::string> pointers;
    for (const CaseChange& change : changes_of(before.root, now.root)) pointers.push_back(change.pointer);
    first.source = changed.source;
    check_parameters(first, to, pointers);
    set_parameters(first, to, pointers);
    first.name = changed.name, first.end = changed.end, first.interval = changed.interval;
    first.frame_interval = changed.frame_interval;
    first.notices = changed.notices;
    return first;
}

/// The text of case-given.json for a case that was read from a text
std::string given_text(const std::string& text, const std::string& file, const Case& c)
{
    return canonical(text, file) == io::written(c.source.root) ? "" : text;
}

}  // namespace

std::string id_of(const Case& c) { return identity(c.source) + c.files_read; }

Continuation new_run(const std::string& text, const std::string& file, const Environment& environment)
{
    Continuation run{.c = read_case(text, file, environment)};
    run.given = given_text(text, file, run.c);
    add_stages(run.c, environment);
    return run;
}

Continuation continued_run(const std::string& text, const std::string& file, const Environment& environment,
                           const std::string& directory, const io::JsonSource& earlier)
{
    const std::string case_file = directory + "/case.json", given_file = directory + name_of_given,
                      first_file = directory + '/' + name_of_earlier_case(1),
                      given = exists(given_file) ? io::read_file(given_file, most_of_case)
                                                 : earlier.current_text();
    const bool is_edited = canonical(text, file) != canonical(given, given_file);
    const auto with_options = [&](const std::string& of, const std::string& name) {
        return io::written(changed_source(of, name, environment).root);
    };
    // messages have the name of the given file if it gives the case with the same options
    const bool takes_file =
        is_edited || with_options(text, file) == with_options(earlier.current_text(), case_file);
    const std::string present = takes_file ? text : earlier.current_text();
    const std::string present_file = takes_file ? file : case_file;

    Environment of_changed = environment;
    of_changed.with_particles = false;
    Case changed = read_case(present, present_file, of_changed);
    const io::JsonSource before = identity_of(earlier), now = identity_of(changed.source);
    const std::vector<CaseChange> changes = changes_of(before.root, now.root);
    check_possible(changes, directory, !changed.stage_specs.empty());

    const std::string new_given = is_edited ? given_text(text, file, changed)
                                  : canonical(given, given_file) == io::written(changed.source.root) ? ""
                                                                                                     : given;
    const bool has_state = io::CheckpointFiles(directory).exist() || exists(directory + "/checkpoint.end");
    if (!has_state || (changes.empty() && !exists(first_file))) {
        Continuation run{.c = read_case(present, present_file, environment), .given = new_given};
        add_stages(run.c, environment);
        return run;
    }
    Environment of_first = environment;
    of_first.settings.clear(), of_first.seed.reset(), of_first.continues = nullptr;
    const std::string of = exists(first_file) ? first_file : case_file;
    const CaseParameters to = parameters_of(changed);
    Continuation run{.c = merged(read_case(io::read_file(of, most_of_case), of, of_first), changed, to)};
    run.given = new_given, run.changed = to;
    add_stages(run.c, environment);
    for (const CaseChange& change : changes)
        run.changes.push_back(change.text()), run.pointers.push_back(change.pointer);
    run.earlier_id = identity(earlier) + run.c.files_read;
    run.earlier_text = earlier.current_text();
    run.earlier_interval = *before.root.member("interval")->value.number();
    return run;
}

std::string name_of_earlier_case(std::size_t k) { return "case-" + std::to_string(k) + ".json"; }

void remove_earlier_cases(const std::string& directory)
{
    std::remove((directory + name_of_given).c_str());
    for (std::size_t k = 1; std::remove((directory + '/' + name_of_earlier_case(k)).c_str()) == 0; ++k) {
    }
}

}  // namespace hilda::granular
