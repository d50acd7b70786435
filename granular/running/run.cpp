// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/running/run.hpp"

#include "granular/running/earlier_run.hpp"
#include "granular/running/sink.hpp"
#include "granular/running/watch_report.hpp"
#include "granular/stages/change_history.hpp"
#include "granular/stages/stages.hpp"
#include "granular/stages/step_check.hpp"
#include "io/archive.hpp"
#include "io/files.hpp"
#include "io/json_source.hpp"
#include "io/message.hpp"
#include "io/program.hpp"
#include "io/progress.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>

namespace hilda::granular {

namespace {

namespace fs = std::filesystem;

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

class CaseRun final : public SteppedRun, private io::Verbosity {
public:
    CaseRun(const RunOptions& o, Continuation from, const std::function<Continuation()>& read_again)
        : Verbosity{o.quiet, o.verbose}, o(o), from(std::move(from)), c(this->from.c),
          read_again(read_again), setup{c, o.output, o.outputs}, id(id_of(c)),
          interval(setup.steps_in(c.interval)), steps(std::lround(c.end / c.h)), files(o.output), sinks(setup)
    {}

    int execute()
    {
        if (const std::optional<int> code = prepare()) return *code;
        const int code = run_steps();
        finish(code);
        return code;
    }

    /// See SteppedRun::open()
    void open(long number)
    {
        restored_step = number;
        prepare();
        if (!resumed)
            begin_run(true);
        else if (earlier.end != steps || !from.changes.empty())
            begin_other_case();
    }
    Case& case_of_run() override { return c; }
    void step() override
    {
        stages_are_over(true);  // the last one lasts as long as the mechanism moves
        c.world->step();
        after_step([](const std::string& text) { io::message("hilda: warning: " + text + '\n'); });
    }
    void save() override
    {
        check_state();
        write_checkpoint();
    }
    void close(int code) override
    {
        if (code != io::exit_code::done) status = code >= io::exit_code::signal ? "interrupted" : "failed";
        finish(code);
    }

private:
    /// Makes the run ready for its first step, or restores a checkpoint. Returns the exit code of a run that
    /// is complete already.
    std::optional<int> prepare()
    {
        io::check_output_directory(o.output, o.force || o.resume, io::force_or_resume);
        lock.emplace(o.output);
        for (const std::string& n : c.notices) warn(n);
        check_step();
        start();  // rejects invalid particles before files are written
        log(io::formatted("%zu particles, %zu boundaries, %ld steps of %g s", c.world->count(),
                          c.boundaries.size(), steps, c.h));
        lock->create();
        if (o.resume) earlier = earlier_run(o, c);
        // The mechanism of a co-simulation may have been interrupted after the run of its grains had ended.
        if (earlier.is_complete && earlier.end == steps && from.changes.empty() && restored_step < 0)
            return report_complete(o, c);
        if (earlier.is_complete && earlier.end == steps && restored_step < 0) refuse_end(o, c, c.end);
        resumed = o.resume && load();
        // with --strict the warnings of an earlier part of the run end this one
        if (resumed && !o.strict) known_warnings = c.world->watch().warnings;
        if (o.resume && !resumed) warn(o.output + ": has no checkpoint; starting from the initial state");
        if (!resumed) {
            files.remove();
            io::Sinks<CaseSetup>::remove(o.output);
            std::remove(file("summary.json").c_str());
            remove_earlier_cases(o.output);
            write_case();
            sinks.open();
        }
        resumed_at = c.world->steps();
        begin = saved = Clock::now();
        return {};
    }

    std::string file(const std::string& name) const { return o.output + '/' + name; }

    /// Inserts the particles.
    void start() const
    {
        // Rows that follow quickly have no sample each, because a sample takes about the time of a step.
        constexpr long least = watch_limit::interval / 2;
        c.world->set_watch(true, interval * std::max(1L, (least + interval - 1) / interval));
        insert_particles(c);
    }

    /// Rejects a step above the stability limit, unless --force is given, or was given when the run that is
    /// resumed was started.
    void check_step() const
    {
        const auto warn_at = [&](const std::string& pointer, const std::string& what) {
            warn(c.source.place(pointer) + ": " + what);
        };
        const auto is_accepted = [&](bool is_of_stage) {
            if (o.force || (is_of_stage && o.resume)) return true;
            const bool other_laws = std::any_of(from.pointers.begin(), from.pointers.end(),
                                                [](const std::string& p) { return p.starts_with("/laws"); });
            return o.resume && earlier_case(o.output) && !other_laws;  // at the start of the run
        };
        const auto above = [&](const std::string& pointer, const std::string& what) {
            if (!is_accepted(pointer != "/step")) c.source.fail(pointer, what + "; --force overrides");
            warn_at(pointer, what);
        };
        granular::check_step(c, above, warn_at);
    }

    /// Restores the last checkpoint or, if it is damaged, the one before. Returns false if there is none.
    /// Throws io::UsageError if it is not before the end.
    bool load()
    {
        return files.load([&](const std::string& bytes, const std::string& file) {
            const bool before_change = restore(bytes, file);
            if (restored_step >= 0 && c.world->steps() != restored_step)
                throw io::IoError(io::formatted("%s: is the checkpoint of step %ld, not of step %ld",
                                                file.c_str(), c.world->steps(), restored_step));
            const long most = std::max(earlier.end, steps);
            if (c.world->steps() > most)
                throw io::IoError(
                    io::formatted("%s: the checkpoint is damaged: the run has at most %ld steps, got %ld",
                                  file.c_str(), most, c.world->steps()));
            try {
                check_state();
            } catch (const NotFiniteState& e) {
                throw io::IoError(file + ": the checkpoint is damaged: " + e.what());
            } catch (const ParticleLost&) {  // the first step reports it
            }
            if (c.stages != nullptr && c.stages->have_no_step_left(*c.world) && earlier.end != steps)
                refuse_end_after_stages(o, c.world->t());
            if (c.world->steps() >= steps && restored_step < 0) refuse_end(o, c, c.world->t());
            if (before_change) begin_change();
            rows = history.rows(c.world->steps(), interval);
            recorded = written = c.world->steps();
            log(io::formatted("continues from %s at t = %g s", file.c_str(), c.world->t()));
        });
    }

    /// Restores the state in the bytes of a checkpoint. Returns whether it is that before the changes of this
    /// continuation: a run that was interrupted just after a change has one with it.
    bool restore(const std::string& bytes, const std::string& file)
    {
        const auto read = [&](const std::string& run_id) {
            c.world->from_bytes(bytes, run_id, file, [&](io::Archive& a) {
                io::Sinks<CaseSetup>::Saved saved_parts;
                a.map(saved_parts);
                transfer_insertions(a);
                read_parts(saved_parts, file);
                sinks.open(saved_parts, file);
            });
        };
        try {
            if (from.changes.empty()) return read(id), false;
            try {
                return read(from.earlier_id), true;
            } catch (const io::IoError& e) {
                try {
                    return read(id), false;
                } catch (const io::IoError&) {
                }
                throw;
            }
        } catch (const MeshChanged& e) {
            throw MeshChanged(file, e.boundary, '\'' + c.boundaries[e.boundary] + '\'');
        }
    }

    /// Changes the case at the present instant.
    void begin_change()
    {
        const World& w = *c.world;
        granular::begin_change(c, from.changed, from.pointers);
        std::string all;
        for (const std::string& change : from.changes) all += (all.empty() ? "" : "; ") + change;
        history.all.push_back({.t = w.t(),
                               .step = w.steps(),
                               .rows = history.rows(w.steps(), setup.steps_in(from.earlier_interval)),
                               .what = from.changes});
        if (!o.quiet)
            io::message(
                io::formatted("hilda: %s: the case changes at t = %.9g s: ", o.output.c_str(), w.t()) + all +
                '\n');
    }

    /// Computes the steps. A checkpoint is possible after each of them and does not change the results.
    int run_steps()
    {
        io::ProgressLine line(o.quiet);
        World& w = *c.world;
        try {
            if (!resumed) begin_run(true);
            if (resumed && (earlier.end != steps || !from.changes.empty())) begin_other_case();
            while (w.steps() < steps && io::Interrupt::caught() == 0 && !stages_are_over(true)) {
                w.step();
                after_step([&](const std::string& text) {
                    line.clear();
                    warn(text);
                });
                if (o.checkpoint > 0 && seconds_since(saved) > o.checkpoint && w.steps() < steps) save();
                if (line.is_due()) line.show(progress());
            }
            check_state();  // also the forces, which contacts.csv has
            if (c.stages != nullptr && w.steps() >= steps)
                c.stages->end_run(w, [&](const char* name, const std::string& text) {
                    line.clear();
                    warn_of_stage(name, text);
                });
        } catch (const io::NumericalFailure& e) {
            line.clear();
            io::report(e);
            message = e.what(), status = e.status;
            try {
                save_last_state();
            } catch (const std::exception& not_saved) {
                warn(io::formatted("the last finite state is not saved: %s", not_saved.what()));
            }
            return io::exit_code::numerical_failure;
        } catch (...) {
            line.clear();
            throw;
        }
        line.clear();
        if (is_at_end()) {
            if (c.stages != nullptr && !c.stages->is_last())
                warn("the run has ended in stage '" + c.stages->what().name + "', before its last stage");
            return io::exit_code::done;
        }
        status = "interrupted";
        write_checkpoint();
        if (!o.quiet)
            io::message(io::formatted(
                "hilda: interrupted at t = %.6g s; --resume continues from the checkpoint in %s\n", w.t(),
                o.output.c_str()));
        return io::exit_code::signal + io::Interrupt::caught();
    }

    template <class Warn>
    void after_step(const Warn& warn_of)
    {
        const World& w = *c.world;
        particle_steps += static_cast<double>(w.count());
        if (w.watch().warnings != known_warnings)
            report_watch(w.watch(), known_warnings, o.strict, c.boundaries, [&](const std::string& text) {
                warn_of(io::formatted("t = %.9g s: ", w.t()) + text);
            });
        record();
    }

    /// Records the initial state, in the first stage.
    void begin_run(bool report)
    {
        if (c.stages != nullptr)
            c.stages->begin_run(c, [&](const char* name, const std::string& text) {
                if (report) warn_of_stage(name, text);
            });
        record();
    }
    /// Before a step: begins the next stage if the present one is over. Returns whether all are.
    bool stages_are_over(bool report)
    {
        if (c.stages == nullptr) return false;
        c.stages->update(c, [&](const char* name, const std::string& text) {
            if (report) warn_of_stage(name, text);
        });
        return c.stages->have_ended();
    }
    void warn_of_stage(const char* name, const std::string& text) const
    {
        if (o.strict) throw StrictWarning(name, text + strict_suffix);
        warn(text);
    }
    bool is_at_end() const
    {
        return c.world->steps() == steps || (c.stages != nullptr && c.stages->have_ended());
    }

    /// Passes the state to the sinks that take it. Throws NotFiniteState before it is written.
    void record()
    {
        const long n = c.world->steps();
        if (n == 0 || sinks.next(n - 1) == n) {
            c.world->check_finite();
            sinks.node(n, *c.world);
            written = n;
        }
        recorded = n;
        if (n % interval == 0) ++rows;
    }

    /// Throws NotFiniteState if the state or a contact force is not finite.
    void check_state() const
    {
        c.world->check_finite();
        c.world->check_loads(c.world->totals());
    }
    bool has_finite_state() const
    {
        try {
            check_state();
            return true;
        } catch (const NotFiniteState&) {
            return false;
        }
    }

    /// After a numerical failure: brings the run to the last finite state and saves it, so that the outputs
    /// are those of this state and --resume continues from it.
    void save_last_state()
    {
        const long failed_after = c.world->steps();
        if (c.world->is_complete() && has_finite_state()) {
            if (recorded < failed_after) record();  // a failure that the watch found after the step
        } else {
            compute_again(c.world->is_complete() ? failed_after - 1 : failed_after);
            if (!has_finite_state()) compute_again(written);
        }
        write_checkpoint();
    }

    /// Computes the steps since the last checkpoint, or since the start, again, up to this one. A step that
    /// has failed leaves no state, and a copy before each step would double the memory. The results are the
    /// same.
    void compute_again(long last)
    {
        log("computes the steps before the failure again");
        Continuation again = read_again();
        if (id_of(again.c) != id)
            throw io::IoError(o.file +
                              ": the case has changed during the run; the state before the failure "
                              "cannot be computed again");
        c.world = std::move(again.c.world);  // releases the memory of the world that has failed
        c.insertions = std::move(again.c.insertions);
        c.motions = std::move(again.c.motions);
        c.groups = std::move(again.c.groups), c.stages = std::move(again.c.stages);
        history = {};
        start();
        sinks = io::Sinks<CaseSetup>(setup);
        rows = 0;
        io::ProgressLine line(o.quiet);
        if (!load()) {
            sinks.open();
            begin_run(false);
        }
        while (c.world->steps() < last && io::Interrupt::caught() == 0 && !stages_are_over(false)) {
            c.world->step();
            record();
            if (line.is_due()) line.show(progress());
        }
        line.clear();
    }

    /// The run in the directory has another end or other parameters from here on. It is incomplete, and it
    /// can be resumed at any time: the earlier case is kept before a checkpoint has the change, and
    /// case.json has it thereafter.
    void begin_other_case()
    {
        if (!from.changes.empty())
            io::write_file(file(name_of_earlier_case(history.all.size())), from.earlier_text);
        write_checkpoint();
        write_case();
        std::remove(file("summary.json").c_str());
    }
    void write_case() const
    {
        if (!from.given.empty())
            io::write_file(file("case-given.json"), from.given);
        else
            std::remove(file("case-given.json").c_str());
        io::write_file(file("case.json"), c.source.current_text());
    }

    /// Passes the state of the run on in pieces.
    void write_state(io::Sinks<CaseSetup>::Saved saved_parts, const io::Append& append) const
    {
        add_parts(saved_parts);
        c.world->write(id, append, [&](io::Archive& a) {
            a.map(saved_parts);
            transfer_insertions(a);
        });
    }
    /// The parts of the state that only some runs have, beside those of the sinks
    static constexpr const char *changes_part = "run.changes", *stages_part = "run.stages",
                                *groups_part = "run.groups";
    template <class F>
    static void read_part(const io::Sinks<CaseSetup>::Saved& parts, const char* part, const std::string& file,
                          const F& read)
    {
        const auto at = parts.find(part);
        if (at == parts.end()) throw io::IoError(file + ": the checkpoint is damaged: it has no " + part);
        io::Archive a(at->second, file);
        read(a);
        a.end();
    }
    void add_parts(io::Sinks<CaseSetup>::Saved& parts) const
    {
        if (!history.all.empty()) parts[changes_part] = history.bytes();
        const auto add = [&](bool has_part, const char* part, const auto& write) {
            if (!has_part) return;
            io::Archive a;
            write(a);
            parts[part] = a.bytes();
        };
        add(c.stages != nullptr, stages_part, [&](io::Archive& a) { c.stages->transfer(a); });
        add(changes_groups(), groups_part, [&](io::Archive& a) { c.groups->transfer(a); });
    }
    void read_parts(const io::Sinks<CaseSetup>::Saved& parts, const std::string& file)
    {
        if (const auto at = parts.find(changes_part); at != parts.end()) history.read(at->second, file);
        if (changes_groups())
            read_part(parts, groups_part, file, [&](io::Archive& a) { c.groups->transfer(a); });
        if (c.stages == nullptr) return;
        read_part(parts, stages_part, file, [&](io::Archive& a) { c.stages->transfer(a); });
        c.stages->resume(c);
    }
    bool changes_groups() const
    {
        const auto assigns = [](const StageSpec& s) { return !s.groups.empty(); };
        return c.groups != nullptr &&
               (c.insertions != nullptr || std::any_of(c.stage_specs.begin(), c.stage_specs.end(), assigns));
    }
    void transfer_insertions(io::Archive& a) const
    {
        if (c.insertions != nullptr) c.insertions->transfer(a);
    }

    void write_checkpoint()
    {
        sinks.sync();
        files.save([&](const io::Append& append) { write_state(sinks.save(), append); });
        saved = Clock::now();
        log(io::formatted("checkpoint at t = %g s", c.world->t()));
    }

    /// Text of the progress line
    std::string progress() const
    {
        const World& w = *c.world;
        const double rate_now = rate();
        const double left =
            rate_now > 0 ? (c.end - w.t()) / c.h * static_cast<double>(w.count()) / rate_now : 0;
        const std::string grains = has_flow() ? io::formatted("%zu particles, ", w.count()) : "";
        return io::formatted("t = %.4g of %.4g s, %s%.3g million particle-steps/s, %.0f %%, ", w.t(), c.end,
                             grains.c_str(), 1e-6 * rate_now, std::floor(100 * w.t() / c.end)) +
               io::duration_text(left) + " left";
    }

    /// Whether the number of particles changes
    bool has_flow() const { return c.insertions != nullptr || c.world->removes(); }

    double rate() const { return particle_steps / seconds_since(begin); }  ///< [particle-steps/s]

    /// Writes the remaining outputs, and of a complete run checkpoint.end: the state from which a run to a
    /// later end continues.
    void finish(int code)
    {
        const World& w = *c.world;
        const double speed = rate(), seconds = seconds_since(begin);
        const bool is_done = code == io::exit_code::done;
        const auto saved_sinks = sinks.save();
        sinks.close();
        const std::string text_of_summary = summary(code, speed, seconds);
        io::write_file(file("summary.json"), text_of_summary);
        if (is_done) files.save_final([&](const io::Append& append) { write_state(saved_sinks, append); });
        if (is_done) files.remove_unfinished();
        if (o.json)
            std::fputs(text_of_summary.c_str(), stdout);
        else if (code == io::exit_code::done && !o.quiet)
            std::printf("%s: %zu particles to t = %.6g s in %ld steps, %.3g million particle-steps/s; %s\n",
                        c.name.c_str(), w.count(), w.t(), w.steps(), 1e-6 * speed, o.output.c_str());
    }

    std::string summary(int code, double speed, double seconds) const
    {
        const World& w = *c.world;
        io::Json s = {{"status", status}, {"exit_code", code}};
        if (!message.empty()) s["message"] = message;
        s["case"] = {{"name", c.name},
                     {"particles", w.count()},
                     {"boundaries", c.boundaries.size()},
                     {"step", c.h},
                     {"end", c.end},
                     {"interval", c.interval},
                     {"frame_interval", c.frame_interval},
                     {"set", c.source.changes},
                     {"warnings", c.notices}};
        s["counters"] = {{"steps", w.steps()}, {"rebuilds", w.rebuilds()}, {"rows", rows}, {"t", w.t()}};
        if (w.removes())
            s["outflow"] = {{"particles", static_cast<long>(w.outflow().count)}, {"mass", w.outflow().mass}};
        if (c.insertions != nullptr) {
            io::Json all = io::Json::array();
            for (const Insertion& i : c.insertions->all)
                all.push_back({{"name", i.what().name},
                               {"particles", static_cast<long>(i.count())},
                               {"mass", i.mass()}});
            s["insertions"] = all;
        }
        if (!history.all.empty()) s["changes"] = history.summary();
        if (c.stages != nullptr) s["stages"] = c.stages->summary(w.t());
        if (c.groups != nullptr) s["groups"] = c.groups->names;
        s["kinetic_energy"] = w.kinetic_energy();
        s["watch"] = watch_summary(w.watch());
        s["files"] = sinks.files();
        s["timing"] = {{"wall_seconds", seconds},
                       {"steps_per_second", static_cast<double>(w.steps() - resumed_at) / seconds},
                       {"particle_steps_per_second", speed}};
        s["provenance"] = o.provenance;
        s["provenance"]["bytes_per_particle"] =
            w.count() > 0 ? static_cast<double>(w.bytes()) / static_cast<double>(w.count()) : 0;
        if (resumed_at > 0) s["provenance"]["resumed_at_step"] = resumed_at;
        return s.text();
    }

    const RunOptions o;
    Continuation from;
    Case& c;  ///< of `from`
    const std::function<Continuation()> read_again;
    const CaseSetup setup;
    const std::string id;  ///< of the case and its files; see identity()
    const long interval, steps;
    const io::CheckpointFiles files;
    io::Sinks<CaseSetup> sinks;
    ChangeHistory history;
    long rows = 0;                    ///< of run.csv
    long recorded = -1, written = 0;  ///< last steps that were passed to record() and to a sink
    bool resumed = false;
    long resumed_at = 0, restored_step = -1;
    std::optional<io::OutputLock> lock;
    double particle_steps = 0;        ///< since then
    std::int64_t known_warnings = 0;  ///< of the watch, which were reported
    EarlierRun earlier;
    std::string message, status = "ok";
    Clock::time_point begin, saved;
};

}  // namespace

int run(const RunOptions& options, Continuation run, const std::function<Continuation()>& read_again)
{
    return CaseRun(options, std::move(run), read_again).execute();
}

std::unique_ptr<SteppedRun> SteppedRun::open(const RunOptions& options, Continuation run, long restore)
{
    auto opened = std::make_unique<CaseRun>(options, std::move(run), nullptr);
    opened->open(restore);
    return opened;
}

}  // namespace hilda::granular
