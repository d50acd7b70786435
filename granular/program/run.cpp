// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/program/run.hpp"

#include "granular/files.hpp"
#include "granular/output.hpp"
#include "granular/program/progress.hpp"
#include "granular/text_place.hpp"

#include <nlohmann/json.hpp>

#include <omp.h>
#include <cmath>
#include <cstdio>
#include <filesystem>

namespace hilda::granular {

volatile std::sig_atomic_t caught = 0;

namespace {

class Run {
public:
    Run(const Options& o, Case c) : o(o), c(std::move(c)) {}

    int go()
    {
        namespace fs = std::filesystem;
        std::error_code none;
        if (fs::is_directory(o.output, none) && !fs::is_empty(o.output, none) && !o.force && !o.resume) {
            std::fprintf(stderr,
                         "hilda: error: %s: is not empty; --force starts it again, --resume goes on\n",
                         o.output.c_str());
            return usage;
        }
        if (!judge_step()) return bad_case;
        try {
            // which refuses what is wrong with the particles, while nothing is written
            c.world->step(0);
        } catch (const InvalidCase& e) {
            throw InvalidCase(o.file + ": " + e.what());
        }
        make_directory(o.output);
        every = std::max(1L, std::lround(c.every / c.h));
        anew = std::max(1L, std::lround(c.anew / c.h));
        steps = std::lround(c.end / c.h);
        if (o.resume && done()) {
            if (!o.quiet) std::fprintf(stderr, "hilda: %s: is done already\n", o.output.c_str());
            return ok;
        }
        if (!o.resume || !load()) {
            for (const char* old : {"checkpoint", "checkpoint.1", "summary.json"})
                std::remove(file(old).c_str());
            write_file(file("case.json"), c.text);
            csv = "t,kinetic_energy,contacts,pairs";
            for (const std::string& b : c.boundaries)
                for (const char* of : {"_Fx", "_Fy", "_Fz", "_Tx", "_Ty", "_Tz"}) csv += ',' + b + of;
            csv += '\n';
        }
        begin = saved = Clock::now();
        const int code = march();
        finish(code);
        return code;
    }

private:
    std::string file(const std::string& name) const { return o.output + '/' + name; }

    /// Above a fifth of the Rayleigh time or a fifteenth of a collision a step is coarse; above the one, or two pi-ths of
    /// the other, it is not stable.
    bool judge_step() const
    {
        const World::StepLimits limits = c.world->step_limits();
        const double stable = std::min(limits.rayleigh, 2 / M_PI * limits.collision);
        if (c.h > stable) {
            std::fprintf(stderr,
                         "hilda: %s: %s:%s (/step): must not be above %.3g s, where it is stable, got %g%s\n",
                         o.force ? "warning" : "error", o.file.c_str(),
                         text_place(c.text, std::string("/step")).c_str(), stable, c.h,
                         o.force ? "" : "; --force overrides");
            return o.force;
        }
        if (!o.quiet && (c.h > 0.2 * limits.rayleigh || c.h > limits.collision / 15))
            std::fprintf(
                stderr,
                "hilda: warning: the step %g s is %.2g of the Rayleigh time and %.2g of a collision\n", c.h,
                c.h / limits.rayleigh, c.h / limits.collision);
        return true;
    }

    /// Whether this very case was run to its end here
    bool done() const
    {
        namespace fs = std::filesystem;
        if (fs::exists(file("checkpoint")) || !fs::exists(file("summary.json"))) return false;
        const auto summary =
            nlohmann::json::parse(read_file(file("summary.json"), std::size_t{1} << 24), nullptr, false);
        if (!summary.is_object() || summary.value("status", "") != "ok") return false;
        if (read_file(file("case.json"), std::size_t{1} << 28) != c.text)
            throw FileError(file("case.json") + ": is another case, which was run to its end here");
        return true;
    }

    /// Goes on from the last checkpoint, or where that is damaged from the one before. False where there is none.
    bool load()
    {
        std::string damage;
        for (const char* name : {"checkpoint", "checkpoint.1"}) {
            if (!std::filesystem::exists(file(name))) continue;
            try {
                c.world->from_bytes(read_file(file(name), std::size_t{1} << 40), run_text(), file(name));
            } catch (const FileError& e) {
                if (damage.empty()) damage = e.what();
                continue;
            }
            if (!damage.empty())
                std::fprintf(stderr, "hilda: warning: %s; going on from the one before\n", damage.c_str());
            load_rows();
            return true;
        }
        if (!damage.empty()) throw FileError(damage);
        return false;
    }

    /// Rows after the checkpoint are made again.
    void load_rows()
    {
        csv = read_file(file("run.csv"), std::size_t{1} << 32);
        const long rows = c.world->steps() / every + 2;  // with the names, and that of t = 0
        std::size_t at = 0;
        for (long k = 0; k < rows; ++k) {
            at = csv.find('\n', at);
            if (at++ == std::string::npos)
                throw FileError(file("run.csv") + ": should have " + std::to_string(rows) + " lines, got " +
                                std::to_string(k));
        }
        csv.resize(at);
        if (!o.no_vtk)
            for (long k = 0; k < rows - 1; ++k)
                frames.emplace_back(static_cast<double>(k * every) * c.h, frame(k));
    }

    /// What a checkpoint must belong to
    std::string run_text() const { return c.text + '\n' + std::to_string(c.h); }

    static std::string frame(long k)
    {
        char name[48];
        std::snprintf(name, sizeof name, "particles-%06ld.vtp", k);
        return name;
    }

    /// Files are written by the clock, but only at times that the case sets: there the neighbours are looked for anew, as by
    /// a world that was loaded, whether a file is written or not. So neither the clock nor a signal changes a bit.
    int march()
    {
        Progress line(o.quiet);
        World& w = *c.world;
        long since = w.steps();
        try {
            if (w.steps() == 0) record();
            while (w.steps() < steps) {
                const long next =
                    std::min({(w.steps() / every + 1) * every, (w.steps() / anew + 1) * anew, steps});
                // no more than about a tenth of a second between looks at the clock
                while (w.steps() < next) {
                    const long most = std::max(1L, 1000000L / static_cast<long>(w.count() + 1));
                    w.step(std::min(most, next - w.steps()));
                    line.update(c, static_cast<double>(w.steps() - since) * static_cast<double>(w.count()) /
                                       seconds_since(begin));
                }
                if (w.steps() % every == 0) record();
                if (w.steps() % anew != 0 || w.steps() == steps) continue;
                w.look_again();
                const bool stop = caught != 0;
                if (stop || (o.checkpoint > 0 && seconds_since(saved) > o.checkpoint)) save();
                if (stop) break;
            }
        } catch (const ParticleLost& e) {
            line.clear();
            std::fprintf(stderr, "hilda: error[particle_lost]: %s\n", e.what());
            message = e.what(), status = "particle_lost";
            return numerical;
        } catch (const NotFinite& e) {
            line.clear();
            std::fprintf(stderr, "hilda: error[not_finite]: %s\n", e.what());
            message = e.what(), status = "not_finite";
            return numerical;
        }
        line.clear();
        rate = static_cast<double>(w.steps() - since) * static_cast<double>(w.count()) / seconds_since(begin);
        if (w.steps() < steps) {
            status = "interrupted";
            if (!o.quiet)
                std::fprintf(stderr, "hilda: interrupted; --resume goes on from the checkpoint in %s\n",
                             o.output.c_str());
            return by_signal + caught;
        }
        return ok;
    }

    void save()
    {
        write_file(file("run.csv"), csv);
        const std::string bytes = c.world->to_bytes(run_text());
        std::rename(file("checkpoint").c_str(),
                    file("checkpoint.1").c_str());  // there is none the first time
        write_file(file("checkpoint"), bytes);
        saved = Clock::now();
    }

    void record()
    {
        const World& w = *c.world;
        const std::vector<Contact> contacts = w.contacts();
        std::vector<Wrench> on(c.boundaries.size());
        for (const Contact& at : contacts)
            if (at.boundary) {
                on[at.j].F -= at.F;
                on[at.j].T -= (at.C - c.world->boundary(static_cast<int>(at.j)).r).cross(at.F) + at.T;
            }
        char row[128];
        std::snprintf(row, sizeof row, "%.12g,%.9g,%zu,%zu", w.t(), w.kinetic_energy(), contacts.size(),
                      w.candidates());
        csv += row;
        for (const Wrench& l : on)
            for (const Vec3& part : {l.F, l.T}) {
                std::snprintf(row, sizeof row, ",%.9g,%.9g,%.9g", part.x, part.y, part.z);
                csv += row;
            }
        csv += '\n';
        if (o.no_vtk) return;
        const std::string name = frame(w.steps() / every);
        make_directory(file("vtk"));
        write_file(file("vtk/" + name), particles_vtp(w));
        frames.emplace_back(w.t(), name);
    }

    void finish(int code)
    {
        const World& w = *c.world;
        write_file(file("run.csv"), csv);
        write_file(file("particles.csv"), particles_csv(w));
        write_file(file("contacts.csv"), contacts_csv(w));
        if (!frames.empty()) write_file(file("vtk/run.pvd"), pvd(frames));
        nlohmann::ordered_json s = {
            {"case", c.name},
            {"status", status},
            {"particles", w.count()},
            {"step", c.h},
            {"t", w.t()},
            {"steps", w.steps()},
            {"rebuilds", w.rebuilds()},
            {"kinetic_energy", w.kinetic_energy()},
            {"particle_steps_per_second", rate},
            {"bytes_per_particle",
             w.count() > 0 ? static_cast<double>(w.bytes()) / static_cast<double>(w.count()) : 0},
            {"threads", omp_get_max_threads()},
            {"device", o.device},
            {"notices", c.notices}};
        if (!message.empty()) s["message"] = message;
        write_file(file("summary.json"), s.dump(2) + '\n');
        if (code == ok)
            for (const char* old : {"checkpoint", "checkpoint.1", "checkpoint.new"})
                std::remove(file(old).c_str());
        if (code == ok && !o.quiet)
            std::printf("%s: %zu particles to t = %.6g s in %ld steps, %.3g million particle-steps/s; %s\n",
                        c.name.c_str(), w.count(), w.t(), w.steps(), 1e-6 * rate, o.output.c_str());
    }

    const Options& o;
    Case c;
    long every = 1, anew = 1, steps = 0;
    std::string csv, message, status = "ok";
    std::vector<std::pair<double, std::string>> frames;
    Clock::time_point begin, saved;
    double rate = 0;
};

}  // namespace

int run(const Options& options, Case c) { return Run(options, std::move(c)).go(); }

}  // namespace hilda::granular
