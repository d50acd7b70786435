// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/granular_bindings/world_object.hpp"

#include "granular/program/device_name.hpp"
#include "granular/program/memory.hpp"
#include "granular/running/watch_report.hpp"
#include "granular/stages/stages.hpp"
#include "granular/stages/step_check.hpp"
#include "io/error.hpp"
#include "io/message.hpp"

#include <omp.h>
#include <pthread.h>

#include <atomic>

namespace hilda::python {

namespace {

using namespace hilda::granular;

/// Whether a world has computed on several threads in this process, and in the one from which it was forked.
/// The threads of OpenMP do not exist in a forked process, where a loop on several threads would wait for
/// them forever.
std::atomic<bool> has_threads = false, had_threads = false;

void watch_forks()
{
    static const int registered =
        pthread_atfork(nullptr, nullptr, [] { had_threads = had_threads || has_threads; });
    if (registered != 0) throw io::NotAvailable("World: the handler of forks cannot be registered");
}

Environment environment_of(const WorldSettings& settings)
{
    Environment here{.memory = available_memory(), .seed = settings.seed, .folder = settings.folder};
    here.base = settings.base, here.removable = true;
    const std::optional<Device> device = device_named(settings.device);
    if (!device)
        throw io::InvalidInput("World: the device must be cpu, cuda or cuda:N, got '" + settings.device +
                               "'");
    here.device = *device;
    if (device->kind == Device::cuda) here.device_memory = gpu_memory(device->number);
    for (const std::string& change : settings.set) here.settings.push_back({change});
    return here;
}

/// Throws io::UsageError if loops on several threads are not possible in this process.
int possible_threads(int number)
{
    watch_forks();
    if (number > 1 && had_threads)
        throw io::UsageError(
            "World: this process was forked from one whose worlds had several threads, which OpenMP does not "
            "support; use threads=1, or start processes by the method spawn, got threads=" +
            std::to_string(number));
    has_threads = has_threads || number > 1;
    return number;
}

Continuation case_of(const std::string& text, const std::string& file, const WorldSettings& settings)
{
    const Threads threads(settings.threads);
    const Environment here = environment_of(settings);
    make_engine(here.device);  // reports a missing device before the case is read
    return new_run(text, file, here);
}

}  // namespace

Threads::Threads(int number) : before(omp_get_max_threads()) { omp_set_num_threads(number); }
Threads::~Threads() { omp_set_num_threads(before); }

WorldObject::WorldObject(const std::string& text, const std::string& file, const WorldSettings& settings)
    : threads(possible_threads(settings.threads)), run(case_of(text, file, settings))
{
    const Threads own(threads);
    Case& c = run.c;
    warnings = c.notices;
    const auto warn = [&](const std::string& pointer, const std::string& what) {
        warnings.push_back(c.source.place(pointer) + ": " + what);
    };
    const auto above = [&](const std::string& pointer, const std::string& what) {
        if (!settings.force) c.source.fail(pointer, what + "; --accept-step accepts it");
        warn(pointer, what);
    };
    check_step(c, above, warn);
    c.world->set_watch(settings.watch);
    insert_particles(c);
    if (c.stages != nullptr)
        c.stages->begin_run(
            c, [&](const char* /*name*/, const std::string& warning) { warnings.push_back(warning); });
}

/// Calls f, which changes the world.
template <class F>
void WorldObject::recorded(const F& f)
{
    try {
        ++changes;
        f();
    } catch (const std::exception& e) {
        failure = e.what();
        throw;
    }
}

bool WorldObject::stages_are_over()
{
    if (of().stages == nullptr) return false;
    recorded([&] {
        of().stages->update(
            of(), [&](const char* /*name*/, const std::string& warning) { warnings.push_back(warning); });
    });
    return of().stages->have_ended();
}

void WorldObject::end_run()
{
    if (of().stages == nullptr) return;
    of().stages->end_run(
        world(), [&](const char* /*name*/, const std::string& warning) { warnings.push_back(warning); });
    if (!of().stages->is_last())
        warnings.push_back("the run has ended in stage '" + of().stages->what().name +
                           "', before its last stage");
}

void WorldObject::step()
{
    recorded([&] {
        world().step();
        report_watch(world().watch(), known_warnings, false, of().boundaries, [&](const std::string& text) {
            warnings.push_back(io::formatted("t = %.9g s: ", world().t()) + text);
        });
    });
}

void WorldObject::insert()
{
    recorded([&] { world().step(0); });
}

void WorldObject::check(const std::string& what, bool for_step) const
{
    if (!failure.empty() && (for_step || !run.c.world->is_complete()))
        throw io::UsageError(what + ": the world has failed and cannot be used any more: " + failure);
}

Use::Use(WorldObject& of, const std::string& what, For purpose)
    : of(of), is_nested(of.user == std::this_thread::get_id())
{
    if (getpid() != of.process)
        throw io::UsageError(what +
                             ": the world was made before this process was forked; make it afterwards");
    if (!is_nested && of.user != std::thread::id())
        throw io::UsageError(what + ": another thread is using this world");
    if (is_nested && purpose == steps)
        throw io::UsageError(what + ": a function that is called before each step must not compute steps");
    if (purpose != queries) of.check(what, purpose == steps);
    if (is_nested) return;
    of.user = std::this_thread::get_id();
    threads.emplace(of.threads);
}

Use::~Use()
{
    if (!is_nested) of.user = {};
}

}  // namespace hilda::python
