// SPDX-License-Identifier: GPL-3.0-or-later
/// A granular world in Python: a case, and who uses it.

#pragma once

#include "granular/stages/continuation.hpp"

#include <pybind11/pybind11.h>
#include <unistd.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace hilda::python {

namespace py = pybind11;

/// Options of a world, as those of the program
struct WorldSettings {
    std::vector<std::string> set;  ///< "/json/pointer=VALUE"
    std::string folder;            ///< that contains all files of the case; empty: they may be anywhere
    std::string base;              ///< folder of relative names of files; empty: the current one
    std::optional<std::uint64_t> seed;
    int threads = 1;  ///< of OpenMP
    std::string device = "cpu";
    bool force = false;  ///< accept a step above the stability limit
    bool watch = true;   ///< see World::set_watch()
};

/// A world at an instant between two steps, with the particles of its case inserted and its first stage
/// begun.
///
/// The order of the calls is that of hilda-granular run, so that the states are bitwise equal.
class WorldObject {
public:
    /// Throws io::InvalidInput, io::UsageError, io::NotAvailable, granular::DeviceError.
    WorldObject(const std::string& text, const std::string& file, const WorldSettings& settings);
    WorldObject(const WorldObject&) = delete;
    WorldObject& operator=(const WorldObject&) = delete;

    granular::Case& of() { return run.c; }
    granular::World& world() { return *run.c.world; }

    /// Begins the next stage if the present one is over. Returns whether all are.
    bool stages_are_over();
    /// After the last step: warns if the condition of the present stage is not met.
    void end_run();
    /// One step. A failure is recorded, and the world computes no further step.
    void step();
    /// Inserts pending particles. A failure is recorded as that of a step.
    void insert();
    /// Throws io::UsageError if there is no state, or for a step if the world has failed.
    void check(const std::string& what, bool for_step) const;

    std::vector<std::string> warnings;  ///< of the case, its stages and the watch
    std::uint64_t changes = 0;          ///< number of steps and changes of particles
    /// Arrays of the particles, and the value of `changes` for which they are valid
    struct Columns {
        std::uint64_t at = 0;
        py::object arrays;
    } motion, properties;

private:
    friend class Use;

    template <class F>
    void recorded(const F& f);

    const int threads;
    granular::Continuation run;
    std::string failure;              ///< empty: none
    std::int64_t known_warnings = 0;  ///< of the watch
    const pid_t process = getpid();
    std::thread::id user;  ///< thread that uses it; default: none
};
using WorldPointer = std::shared_ptr<WorldObject>;

/// The number of threads of OpenMP in a scope
class Threads {
public:
    explicit Threads(int number);
    ~Threads();
    Threads(const Threads&) = delete;
    Threads& operator=(const Threads&) = delete;

private:
    const int before;
};

/// The use of a world by a function of the module, with the number of threads of the world. To be constructed
/// and destroyed with the GIL; a nested use by the same thread is that of a function before a step.
class Use {
public:
    enum For {
        queries,  ///< that need no state of the particles
        reading,
        steps
    };

    /// `what`: the function, for messages. Throws io::UsageError if another thread or process has the world,
    /// if a function before a step computes steps, or if the world has failed.
    Use(WorldObject& of, const std::string& what, For purpose = reading);
    ~Use();
    Use(const Use&) = delete;
    Use& operator=(const Use&) = delete;

private:
    WorldObject& of;
    const bool is_nested;
    std::optional<Threads> threads;
};

}  // namespace hilda::python
