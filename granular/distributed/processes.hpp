// SPDX-License-Identifier: GPL-3.0-or-later
/// A run on several processes: the first one reads the case, computes with the engine that they share, and
/// writes the outputs. The others serve this engine.

#pragma once

#include "granular/backend/engine.hpp"

#include <memory>
#include <string>

namespace hilda::granular {

class Processes {
public:
    virtual ~Processes() = default;
    virtual int count() const = 0;
    /// Whether this process is the one that runs the program
    virtual bool is_first() const = 0;
    /// Engines of all processes, for the first one
    virtual EngineSource& engines() = 0;
    /// Of the other processes: serves the engines until the first process ends. Returns its exit code.
    virtual int serve() = 0;
    /// Of the first process: ends the others with the same exit code.
    virtual void end(int code) = 0;
    /// One line about the division of the work, for --verbose
    virtual std::string report() const = 0;
    /// Ends all processes with this exit code, at once.
    [[noreturn]] virtual void abort(int code) = 0;
};

/// A way to start several processes
struct ProcessesType {
    const char* name;
    /// Returns nullptr if this program was not started as one of several processes.
    std::unique_ptr<Processes> (*start)(int& argc, char**& argv);
};

/// The processes of which this is one; nullptr if it runs alone
std::unique_ptr<Processes> start_processes(int& argc, char**& argv);

}  // namespace hilda::granular
