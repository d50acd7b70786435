// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/running/run.hpp"

#include "granular/running/case_checkpoint.hpp"
#include "granular/running/earlier_run.hpp"
#include "granular/running/run_summary.hpp"
#include "granular/running/watch_report.hpp"
#include "granular/stages/stages.hpp"
#include "granular/stages/step_check.hpp"
#include "io/files.hpp"
#include "io/json_source.hpp"
#include "io/message.hpp"
#include "io/resumable.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace hilda::granular {

namespace {

class CaseRun final : public SteppedRun, private io::Resumable {
public:
    CaseRun(const RunOptions& o, Continuation from, const std::function<Continuation()>& read_again)
        : Resumable({.directory = o.output,
                     .checkpoint = o.checkpoint,
                     .resume = o.resume,
                     .quiet = o.quiet,
                     .verbose = o.verbose,
                     .force = o.force}),
          o(o), from(std::move(from)), c(this->from.c), read_again(read_again), setup{c, o.output, o.outputs},
          saved_state(this->from), interval(setup.steps_in(c.interval)), steps(std::lround(c.end / c.h)),
          sinks(setup)
    {}

    using Resumable::execute;

    /// See SteppedRun::open()
    void begin_at(long number)
    {
        restored_step = number;
        if (!prepare()) throw io::UsageError(o.output + ": its run is complete; --force starts it again");
        open();
    }
    Case& case_of_run() override { return c; }
    void step() override
    {
        stages_are_over(true);  // the last one lasts as long as the mechanism moves
        c.world->step();
        after_step([](const std::string& text) { io::message("hilda: warning: " + text + '\n'); });
    }
    void save() override { Resumable::save(); }
    void close(int exit_code) override
    {
        code = exit_code;
        if (code != io::exit_code::done) status = code >= io::exit_code::signal ? "interrupted" : "failed";
        finish();
    }

private:
    bool read() override
    {
        if (o.strict && !c.doubtful.empty()) throw io::InvalidInput(c.doubtful.front() + strict_suffix);
        for (const std::string& n : c.notices) warn(n);
        check_step();
        start();  // rejects invalid particles before files are written
        log(io::formatted("%zu particles, %zu boundaries, %ld steps of %g s", c.world->count(),
                          c.boundaries.size(), steps, c.h));
        if (o.resume) earlier = earlier_run(o, c);
        // The mechanism of a co-simulation may have been interrupted after the run of its grains had ended.
        if (!earlier.is_complete || earlier.end != steps || restored_step >= 0) return true;
        if (!from.changes.empty()) refuse_end(o, c, c.end);
        code = report_complete(o, c);
        return false;
    }
    void check() override
    {
        if (restored_step > 0 && !resumed)
            throw io::IoError(
                io::formatted("%s: has no checkpoint of step %ld, from which the mechanism "
                              "continues; --force starts both again",
                              o.output.c_str(), restored_step));
        // with --strict the warnings of an earlier part of the run end this one
        if (resumed && !o.strict) known_warnings = c.world->watch().warnings;
        resumed_at = c.world->steps();
    }
    void clear() override
    {
        io::Sinks<CaseSetup>::remove(o.output);
        remove_earlier_cases(o.output);
        write_case();
    }
    void open() override
    {
        if (!resumed) {
            sinks.open();
            begin_run(true);
        } else if (earlier.end != steps || !from.changes.empty()) {
            begin_other_case();
        }
    }

    /// Inserts the particles.
    void start() const
    {
        // Rows that follow quickly have no sample each, because a sample takes about the time of a step.
        constexpr long least = watch_limit::interval / 2;
        c.world->set_watch(true, interval * std::max(1L, (least + interval - 1) / interval));
        insert_particles(c);
    }

    /// Rejects a step above the stability limit, unless --accept-step is given, or was given when the run
    /// that is resumed was started.
    void check_step()
    {
        const auto warn_at = [&](const std::string& pointer, const std::string& what) {
            warn(c.source.place(pointer) + ": " + what);
        };
        const auto is_accepted = [&](bool is_of_stage) {
            if (o.accept_step || (is_of_stage && o.resume)) return true;
            const bool other_laws = std::any_of(from.pointers.begin(), from.pointers.end(),
                                                [](const std::string& p) { return p.starts_with("/laws"); });
            return o.resume && earlier_case(o.output) && !other_laws;  // at the start of the run
        };
        const auto above = [&](const std::string& pointer, const std::string& what) {
            if (!is_accepted(pointer != "/step")) c.source.fail(pointer, what + "; --accept-step accepts it");
            warn_at(pointer, what);
        };
        granular::check_step(c, above, warn_at);
    }

    /// Throws io::UsageError if the checkpoint is not before the end.
    void restore(const std::string& bytes, const std::string& file) override
    {
        const bool before_change = saved_state.read(bytes, file, sinks);
        const long n = c.world->steps(), most = std::max(earlier.end, steps);
        if (restored_step >= 0 && n != restored_step)
            throw io::IoError(io::formatted("%s: is the checkpoint of step %ld, not of step %ld",
                                            file.c_str(), n, restored_step));
        if (n > most)
            throw io::IoError(
                io::formatted("%s: the checkpoint is damaged: the run has at most %ld steps, got %ld",
                              file.c_str(), most, n));
        try {
            check_state();
        } catch (const NotFiniteState& e) {
            throw io::IoError(file + ": the checkpoint is damaged: " + e.what());
        } catch (const ParticleLost&) {  // the first step reports it
        }
        if (c.stages != nullptr && c.stages->have_no_step_left(*c.world) && earlier.end != steps)
            refuse_end_after_stages(o, c.world->t());
        const bool has_other_end = earlier.end != steps || !from.changes.empty();
        if (restored_step < 0 && (n > steps || (n == steps && has_other_end))) refuse_end(o, c, c.world->t());
        if (before_change) begin_change();
        rows = history().rows(n, interval);
        recorded = written = n;
    }

    /// Changes the case at the present instant.
    void begin_change()
    {
        const World& w = *c.world;
        granular::begin_change(c, from.changed, from.pointers);
        std::string all;
        for (const std::string& change : from.changes) all += (all.empty() ? "" : "; ") + change;
        history().all.push_back({.t = w.t(),
                                 .step = w.steps(),
                                 .rows = history().rows(w.steps(), setup.steps_in(from.earlier_interval)),
                                 .what = from.changes});
        if (!o.quiet)
            io::message(
                io::formatted("hilda: %s: the case changes at t = %.9g s: ", o.output.c_str(), w.t()) + all +
                '\n');
    }

    bool at_end() const override
    {
        return c.world->steps() == steps || (c.stages != nullptr && c.stages->have_ended());
    }
    bool next_step() override
    {
        if (stages_are_over(true)) return false;
        check_overlap_of_resumed();
        c.world->step();
        after_step([&](const std::string& text) { warn(text); });
        return true;
    }
    /// A run that ended because of an overlap has saved the state after that step. It ends there again.
    void check_overlap_of_resumed() const
    {
        const World& w = *c.world;
        if (!resumed || w.steps() != resumed_at) return;
        if (const double largest = w.watch().largest_overlap; largest > w.largest_overlap())
            throw OverlapTooLarge(
                io::formatted("the largest overlap of two bodies is %.3g of the smaller radius, more than "
                              "%g, at t = %.9g s, "
                              "where the run has ended before",
                              largest, w.largest_overlap(), w.t()));
    }
    void end() override
    {
        check_state();  // also the forces, which contacts.csv has
        if (c.insertions != nullptr)
            for (const Insertion& i : c.insertions->all)
                if (const std::string text = i.shortfall(c.world->t(), c.h); !text.empty())
                    warn_of_stage("insertion_behind", text);
        if (c.stages == nullptr) return;
        if (c.world->steps() >= steps)
            c.stages->end_run(*c.world,
                              [&](const char* name, const std::string& text) { warn_of_stage(name, text); });
        if (!c.stages->is_last())
            warn("the run has ended in stage '" + c.stages->what().name + "', before its last stage");
    }
    void failed(const io::NumericalFailure& failure) override
    {
        io::report(failure);
        try {
            save_last_state();
        } catch (const std::exception& not_saved) {
            warn(io::formatted("the last finite state is not saved: %s", not_saved.what()));
        }
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
    void warn_of_stage(const char* name, const std::string& text)
    {
        if (o.strict) throw StrictWarning(name, text + strict_suffix);
        warn(text);
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
        Resumable::save();
    }

    /// Computes the steps since the last checkpoint, or since the start, again, up to this one. A step that
    /// has failed leaves no state, and a copy before each step would double the memory. The results are the
    /// same.
    void compute_again(long last)
    {
        log("computes the steps before the failure again");
        Continuation again = read_again();
        if (id_of(again.c) != saved_state.id)
            throw io::IoError(o.file +
                              ": the case has changed during the run; the state before the failure "
                              "cannot be computed again");
        c.world = std::move(again.c.world);  // releases the memory of the world that has failed
        c.insertions = std::move(again.c.insertions);
        c.motions = std::move(again.c.motions);
        c.groups = std::move(again.c.groups), c.stages = std::move(again.c.stages);
        history() = {};
        start();
        sinks = io::Sinks<CaseSetup>(setup);
        rows = 0;
        if (!load()) {
            sinks.open();
            begin_run(false);
        }
        while (c.world->steps() < last && io::Interrupt::caught() == 0 && !stages_are_over(false)) {
            c.world->step();
            record();
            if (line->is_due()) show(*line, Clock::now());
        }
        line->clear();
    }

    /// The run in the directory has another end or other parameters from here on. It is incomplete, and it
    /// can be resumed at any time: the earlier case is kept before a checkpoint has the change, and
    /// case.json has it thereafter.
    void begin_other_case()
    {
        if (!from.changes.empty())
            io::write_file(path(name_of_earlier_case(history().all.size())), from.earlier_text);
        extend();
        write_case();
    }
    void write_case() const
    {
        if (!from.given.empty())
            io::write_file(path("case-given.json"), from.given);
        else
            std::remove(path("case-given.json").c_str());
        io::write_file(path("case.json"), c.source.current_text());
    }

    ChangeHistory& history() { return saved_state.history; }
    void before_save() override
    {
        check_state();
        sinks.sync();
        saved_sinks = sinks.save();
    }
    void write(const io::Append& append) override { saved_state.write(saved_sinks, append); }

    double time() const override { return c.world->t(); }
    void show(io::ProgressLine& on, Clock::time_point now) const override
    {
        const World& w = *c.world;
        const double rate_now = particle_steps / seconds();  // [particle-steps/s]
        const double left =
            rate_now > 0 ? (c.end - w.t()) / c.h * static_cast<double>(w.count()) / rate_now : 0;
        const bool has_flow = c.insertions != nullptr || w.removes();
        const std::string grains = has_flow ? io::formatted("%zu particles, ", w.count()) : "";
        on.show(io::formatted("t = %.4g of %.4g s, %s%.3g million particle-steps/s, %.0f %%, ", w.t(), c.end,
                              grains.c_str(), 1e-6 * rate_now, std::floor(100 * w.t() / c.end)) +
                    io::duration_text(left) + " left",
                now);
    }

    void close() override
    {
        wall_seconds = seconds();
        sinks.close();
    }
    std::string summary() override
    {
        summary_text = run_summary(o, c, history(),
                                   {.status = status,
                                    .message = message,
                                    .code = code,
                                    .rows = rows,
                                    .resumed_at = resumed_at,
                                    .seconds = wall_seconds,
                                    .particle_steps = particle_steps,
                                    .files = sinks.files()})
                           .text();
        return summary_text;
    }
    void report() override
    {
        const World& w = *c.world;
        if (o.json)
            std::fputs(summary_text.c_str(), stdout);
        else if (code == io::exit_code::done && !o.quiet)
            std::printf("%s: %zu particles to t = %.6g s in %ld steps, %.3g million particle-steps/s; %s\n",
                        c.name.c_str(), w.count(), w.t(), w.steps(), 1e-6 * particle_steps / wall_seconds,
                        o.output.c_str());
    }

    const RunOptions o;
    Continuation from;
    Case& c;  ///< of `from`
    const std::function<Continuation()> read_again;
    const CaseSetup setup;
    CaseCheckpoint saved_state;
    const long interval, steps;
    io::Sinks<CaseSetup> sinks;
    io::Sinks<CaseSetup>::Saved saved_sinks;  ///< for the next checkpoint
    std::string summary_text;
    long rows = 0;                    ///< of run.csv
    long recorded = -1, written = 0;  ///< last steps that were passed to record() and to a sink
    long resumed_at = 0, restored_step = -1;
    double particle_steps = 0, wall_seconds = 0;  ///< since then
    std::int64_t known_warnings = 0;              ///< of the watch, which were reported
    EarlierRun earlier;
};

void check_directory(const RunOptions& o)
{
    io::check_output_directory(o.output, o.force || o.resume, io::force_or_resume);
}

}  // namespace

int run(const RunOptions& options, Continuation run, const std::function<Continuation()>& read_again)
{
    check_directory(options);
    return CaseRun(options, std::move(run), read_again).execute();
}

std::unique_ptr<SteppedRun> SteppedRun::open(const RunOptions& options, Continuation run, long restore)
{
    check_directory(options);
    auto opened = std::make_unique<CaseRun>(options, std::move(run), nullptr);
    opened->begin_at(restore);
    return opened;
}

}  // namespace hilda::granular
