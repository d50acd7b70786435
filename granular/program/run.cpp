// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/program/run.hpp"

#include "granular/files.hpp"
#include "granular/program/progress.hpp"
#include "granular/program/provenance.hpp"
#include "granular/program/rows.hpp"
#include "granular/world/output.hpp"

#include <cmath>
#include <cstdio>
#include <filesystem>

namespace hilda::granular {

volatile std::sig_atomic_t caught = 0;

namespace {

namespace fs = std::filesystem;

long steps_in(double time, double h) { return std::max(1L, std::lround(std::min(time / h, 9e15))); }

class CaseRun {
public:
    CaseRun(const Options& o, Case from)
        : o(o), c(std::move(from)), text(c.source.text()), every(steps_in(c.every, c.h)),
          frames_every(o.no_vtk ? 0 : steps_in(c.frames_every, c.h)), anew(steps_in(c.anew, c.h)),
          steps(std::lround(c.end / c.h)), rows(o.output, c, every, frames_every)
    {}

    int go()
    {
        std::error_code none;
        if (fs::is_directory(o.output, none) && !fs::is_empty(o.output, none) && !o.force && !o.resume) {
            std::fprintf(stderr,
                         "hilda: error: %s: is not empty; --force starts it again, --resume goes on\n",
                         o.output.c_str());
            return usage;
        }
        for (const std::string& n : c.notices) warn(c.source.placed(n));
        judge_step();
        settle(c);  // which refuses what is wrong with the particles, while nothing is written
        say("%zu particles, %zu boundaries, %ld steps of %g s", c.world->count(), c.boundaries.size(), steps,
            c.h);
        make_directory(o.output);
        if (o.resume && done()) {
            if (!o.quiet) std::fprintf(stderr, "hilda: %s: is done already\n", o.output.c_str());
            if (o.json) std::fputs(read_file(file("summary.json"), most_of_summary).c_str(), stdout);
            return ok;
        }
        if (!o.resume || !load()) {
            for (const char* old : {"checkpoint", "checkpoint.1", "summary.json"})
                std::remove(file(old).c_str());
            write_file(file("case.json"), text);
        }
        resumed_at = c.world->steps();
        begin = saved = Clock::now();
        const int code = march();
        finish(code);
        return code;
    }

private:
    static constexpr std::size_t most_of_summary = std::size_t{1} << 24;

    std::string file(const std::string& name) const { return o.output + '/' + name; }

    void warn(const std::string& what) const
    {
        if (!o.quiet) std::fprintf(stderr, "hilda: warning: %s\n", what.c_str());
    }
    template <class... Values>
    void say(const char* format, const Values&... values) const
    {
        if (!o.verbose || o.quiet) return;
        std::fputs("hilda: ", stderr);
        std::fprintf(stderr, format, values...);
        std::fputc('\n', stderr);
    }

    /// Above a fifth of the Rayleigh time or a fifteenth of a collision a step is coarse; above the one, or two pi-ths of
    /// the other, it is not stable.
    void judge_step() const
    {
        const World::StepLimits limits = c.world->step_limits();
        const double stable = std::min(limits.rayleigh, 2 / M_PI * limits.collision);
        char what[160];
        if (c.h > stable) {
            std::snprintf(what, sizeof what, "/step: must not be above %.3g s, where it is stable, got %g",
                          stable, c.h);
            if (!o.force) throw InvalidCase(c.source.placed(std::string(what) + "; --force overrides"));
            warn(c.source.placed(what));
        } else if (c.h > 0.2 * limits.rayleigh || c.h > limits.collision / 15) {
            std::snprintf(what, sizeof what,
                          "/step: %g s is %.2g of the Rayleigh time and %.2g of a collision", c.h,
                          c.h / limits.rayleigh, c.h / limits.collision);
            warn(c.source.placed(what));
        }
        if (c.end < c.h) {
            std::snprintf(what, sizeof what, "/end: must not be before the first step is done, got %g",
                          c.end);
            throw InvalidCase(c.source.placed(what));
        }
    }

    /// Whether this very case was run to its end here. FileError where another one was begun
    bool done() const
    {
        if (!fs::exists(file("case.json"))) return false;
        if (read_file(file("case.json"), std::size_t{1} << 28) != text)
            throw FileError(file("case.json") +
                            ": is another case, or this one with other options; --force starts anew");
        if (fs::exists(file("checkpoint")) || !fs::exists(file("summary.json"))) return false;
        const auto summary =
            nlohmann::json::parse(read_file(file("summary.json"), most_of_summary), nullptr, false);
        return summary.is_object() && summary.value("status", "") == "ok";
    }

    /// Goes on from the last checkpoint, or where that is damaged from the one before. False where there is none.
    bool load()
    {
        std::string damage;
        for (const char* name : {"checkpoint", "checkpoint.1"}) {
            if (!fs::exists(file(name))) continue;
            try {
                c.world->from_bytes(read_file(file(name), std::size_t{1} << 40), text + c.files_read,
                                    file(name));
            } catch (const FileError& e) {
                if (damage.empty()) damage = e.what();
                continue;
            }
            if (!damage.empty()) warn(damage + "; going on from the one before");
            rows.load();
            say("goes on from %s at t = %g s", file(name).c_str(), c.world->t());
            return true;
        }
        if (!damage.empty()) throw FileError(damage);
        return false;
    }

    /// Files are written by the clock, but hold the world at times that the case sets: there the neighbours are looked for
    /// anew, as by a world that was loaded, whether a file is written or not. So neither the clock nor a signal changes a
    /// bit. For a signal between two of these times, the world of the last is kept in memory.
    int march()
    {
        Progress line(o.quiet);
        World& w = *c.world;
        try {
            if (rows.count() == 0) rows.record();
            keep();
            while (w.steps() < steps && caught == 0) {
                long next = steps;
                for (const long between : {every, frames_every, anew})
                    if (between > 0) next = std::min(next, (w.steps() / between + 1) * between);
                while (w.steps() < next && caught == 0) {
                    w.step();
                    line.update(c, rate());
                }
                if (w.steps() < next) break;
                rows.record();
                if (w.steps() % anew == 0 && w.steps() < steps) fixed_time();
            }
        } catch (const ParticleLost& e) {
            line.clear();
            return failed("particle_lost", e.what());
        } catch (const NotFinite& e) {
            line.clear();
            return failed("not_finite", e.what());
        } catch (const DeviceError&) {
            line.clear();
            save();
            throw;
        } catch (const std::bad_alloc&) {
            line.clear();
            save();
            throw;
        }
        line.clear();
        if (w.steps() == steps) return ok;
        status = "interrupted";
        save();
        if (!o.quiet)
            std::fprintf(stderr,
                         "hilda: interrupted at t = %.6g s; --resume goes on from the checkpoint of t = %.6g "
                         "s in %s\n",
                         w.t(), kept_at, o.output.c_str());
        return by_signal + caught;
    }

    void fixed_time()
    {
        // where these times come fast, one in so many seconds is kept, and takes a twentieth of the time at most
        const double seldom = std::max(0.2, 20 * keep_seconds);
        c.world->invalidate_neighbours();
        const bool due = o.checkpoint > 0 && seconds_since(saved) > o.checkpoint;
        if (due || caught != 0 || seconds_since(kept_when) > seldom) keep();
        if (due) save();
    }

    void keep()
    {
        kept.clear();
        kept.shrink_to_fit();  // so that there are not two
        const Clock::time_point from = Clock::now();
        kept = c.world->to_bytes(text + c.files_read);
        kept_at = c.world->t();
        kept_when = Clock::now();
        keep_seconds = seconds_since(from);
    }

    void save()
    {
        if (kept.empty()) return;  // a failure before or while it was taken: what is on the disk stays
        rows.write();
        std::rename(file("checkpoint").c_str(),
                    file("checkpoint.1").c_str());  // there is none the first time
        write_file(file("checkpoint"), kept);
        saved = Clock::now();
        say("checkpoint of t = %g s, %zu bytes", kept_at, kept.size());
    }

    int failed(const char* how, const std::string& what)
    {
        std::fprintf(stderr, "hilda: error[%s]: %s\n", how, what.c_str());
        message = what, status = how;
        return numerical;
    }

    double rate() const  ///< [particle-steps/s]
    {
        return static_cast<double>(c.world->steps() - resumed_at) * static_cast<double>(c.world->count()) /
               seconds_since(begin);
    }

    void finish(int code)
    {
        const World& w = *c.world;
        const double speed = rate(), seconds = seconds_since(begin);
        kept.clear();
        kept.shrink_to_fit();
        rows.write();
        write_file(file("particles.csv"), particles_csv(w));
        write_file(file("contacts.csv"), contacts_csv(w));
        rows.write_frames();
        const std::string told = summary(code, speed, seconds);
        write_file(file("summary.json"), told);
        if (code == ok)
            for (const char* old : {"checkpoint", "checkpoint.1", "checkpoint.new"})
                std::remove(file(old).c_str());
        if (o.json)
            std::fputs(told.c_str(), stdout);
        else if (code == ok && !o.quiet)
            std::printf("%s: %zu particles to t = %.6g s in %ld steps, %.3g million particle-steps/s; %s\n",
                        c.name.c_str(), w.count(), w.t(), w.steps(), 1e-6 * speed, o.output.c_str());
    }

    std::string summary(int code, double speed, double seconds) const
    {
        using Json = nlohmann::ordered_json;
        const World& w = *c.world;
        Json s = {{"status", status}, {"exit_code", code}};
        if (!message.empty()) s["message"] = message;
        Json set = Json::array();
        for (const Setting& setting : c.source.settings())
            set.push_back(setting.pointer + '=' + setting.value);
        s["case"] = {{"name", c.name},
                     {"particles", w.count()},
                     {"boundaries", c.boundaries.size()},
                     {"step", c.h},
                     {"end", c.end},
                     {"every", c.every},
                     {"frames_every", c.frames_every},
                     {"checkpoint_every", c.anew},
                     {"set", set},
                     {"warnings", c.notices}};
        s["counters"] = {
            {"steps", w.steps()}, {"rebuilds", w.rebuilds()}, {"rows", rows.count()}, {"t", w.t()}};
        if (status == "interrupted") s["counters"]["t_checkpoint"] = kept_at;
        s["kinetic_energy"] = w.kinetic_energy();
        s["timing"] = {{"wall_seconds", seconds},
                       {"steps_per_second", static_cast<double>(w.steps() - resumed_at) / seconds},
                       {"particle_steps_per_second", speed}};
        s["provenance"] = provenance(o.command_line, o.threads, o.device_name);
        s["provenance"]["bytes_per_particle"] =
            w.count() > 0 ? static_cast<double>(w.bytes()) / static_cast<double>(w.count()) : 0;
        if (resumed_at > 0) s["provenance"]["resumed_at_step"] = resumed_at;
        return s.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
    }

    const Options& o;
    const Case c;
    const std::string text;
    const long every, frames_every, anew, steps;
    Rows rows;
    long resumed_at = 0;
    std::string kept;                      ///< the world at the last time that may be a checkpoint's
    double kept_at = 0, keep_seconds = 0;  ///< when [s], and what it takes of the clock [s]
    std::string message, status = "ok";
    Clock::time_point begin, saved, kept_when;
};

}  // namespace

int run(const Options& options, Case c) { return CaseRun(options, std::move(c)).go(); }

}  // namespace hilda::granular
