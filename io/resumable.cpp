// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/resumable.hpp"

#include "io/error.hpp"
#include "io/files.hpp"
#include "io/message.hpp"

#include <cstdio>

namespace hilda::io {

namespace {

constexpr const char* summary_file = "summary.json";

double seconds_of(std::chrono::steady_clock::duration d) { return std::chrono::duration<double>(d).count(); }

}  // namespace

Resumable::Resumable(const ResumableOptions& options)
    : Verbosity{options.quiet, options.verbose}, files(options.directory), options(options),
      lock(options.directory, options.force || options.resume, force_or_resume), begin(Clock::now())
{}

int Resumable::execute()
{
    if (!prepare()) return code;
    march();
    finish();
    return code;
}

bool Resumable::prepare()
{
    if (!read()) return false;
    resumed = options.resume && load();
    check();
    if (resumed)
        log(formatted("continues from %s at t = %g s", restored.c_str(), time()));
    else if (options.resume)
        warn(options.directory + ": has no checkpoint; starting from the initial state");
    lock.create();
    if (!resumed) {
        std::remove(path(summary_file).c_str());  // before the checkpoint of the end, which it announces
        files.remove();
        clear();
    }
    begin = saved = Clock::now();
    return true;
}

bool Resumable::load()
{
    return files.load([&](const std::string& bytes, const std::string& file) {
        restore(bytes, file);
        restored = file;
    });
}

void Resumable::march()
{
    line.emplace(quiet);
    const bool watches_clock = line->is_shown() || options.checkpoint > 0;
    try {
        open();
        while (!at_end() && Interrupt::caught() == 0 && next_step()) {
            if (!watches_clock) continue;
            const Clock::time_point now = Clock::now();
            if (options.checkpoint > 0 && seconds_of(now - saved) > options.checkpoint && !at_end()) save();
            if (line->is_due(now)) show(*line, now);
        }
        if (at_end())
            end();
        else
            interrupted();
    } catch (const NumericalFailure& failure) {
        line->clear();
        status = failure.status, message = failure.what(), code = exit_code::numerical_failure;
        failed(failure);
    }
    line.reset();
}

void Resumable::interrupted()
{
    line->clear();
    status = "interrupted", code = exit_code::signal + Interrupt::caught();
    if (can_be_resumed()) save();
    if (quiet) return;
    io::message(formatted("hilda: interrupted at t = %.6g s", time()) +
                (can_be_resumed() ? "; --resume continues from the checkpoint in " + options.directory : "") +
                '\n');
}

void Resumable::failed(const NumericalFailure& failure) { io::report(failure); }

void Resumable::finish()
{
    const bool has_final = code == exit_code::done && can_be_extended();
    if (has_final) before_save();
    close();
    if (has_final) files.save_final([&](const Append& append) { write(append); });
    write_file(path(summary_file), summary());
    if (code == exit_code::done) files.remove_unfinished();
    report();
}

void Resumable::save()
{
    before_save();
    files.save([&](const Append& append) { write(append); });
    saved = Clock::now();
    log(formatted("checkpoint at t = %g s", time()));
}

void Resumable::extend()
{
    save();
    std::remove(path(summary_file).c_str());
}

void Resumable::warn(const std::string& what)
{
    if (line) line->clear();
    Verbosity::warn(what);
}

void Resumable::log(const std::string& what)
{
    if (line) line->clear();
    Verbosity::log(what);
}

double Resumable::seconds() const { return seconds_of(Clock::now() - begin); }

}  // namespace hilda::io
