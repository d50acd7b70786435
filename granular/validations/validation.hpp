// SPDX-License-Identifier: GPL-3.0-or-later
/// Validations: small simulations whose result is known in closed form, from another code or from
/// measurements.
///
/// The computations depend on the folder granular only, so that they can be run on a GPU machine. The study
/// of the same name writes files and figures.

#pragma once

#include "granular/validations/settled_beds.hpp"
#include "granular/world/world.hpp"
#include "io/archive.hpp"
#include "io/registry.hpp"

#include <functional>
#include <string>
#include <variant>
#include <vector>

namespace hilda::granular {

/// A warning of the watch over a run of a validation
struct ValidationWarning {
    std::string name;  ///< of the warning; see watch_warnings
    std::string text;  ///< "RUN: WARNING"
};

/// The warnings of the watch over all runs of a validation
class ValidationWarnings {
public:
    /// Adds those of a run. Runs with equal names count as one.
    void include(const std::string& run, const WatchRecord& record);

    /// All warnings of all runs
    std::vector<ValidationWarning> all() const;
    /// Of each kind of warning that with the largest value, with the number of other runs that have it
    std::vector<ValidationWarning> largest() const;

    /// Adds those of another list.
    void include(const ValidationWarnings& other);
    /// Writes or reads the list.
    void transfer(io::Archive& a);

private:
    struct WarnedRun {
        std::string name;
        WatchRecord record = {};
    };
    std::vector<WarnedRun> runs;
};

/// How an interrupted validation continues. Without a file to continue from, each part is computed.
struct ValidationProgress {
    using Compute = std::function<void()>;
    using Transfer = std::function<void(io::Archive&)>;

    /// Computes a part, or reads its result if it was computed before the interruption. `transfer` writes or
    /// reads the result. The parts of a validation are numbered by the order of the calls.
    std::function<void(const Compute& compute, const Transfer& transfer)> part =
        [](const Compute& compute, const Transfer&) { compute(); };
    using ComputePart = std::function<void(long part)>;
    using TransferPart = std::function<void(io::Archive&, long part)>;
    /// Computes the parts 0 to count - 1, which do not depend on each other, or reads their results.
    /// `compute` may be called for some of them only, in another process, and in any order: a settled bed
    /// is made where it is needed. A validation calls this function once and no part() after it; what follows
    /// is executed where all results are known.
    std::function<void(long count, const ComputePart& compute, const TransferPart& transfer)> parts =
        [](long count, const ComputePart& compute, const TransferPart&) {
            for (long k = 0; k < count; ++k) compute(k);
        };
    using Read = std::function<void(const std::string& bytes, const std::string& file)>;
    /// Calls read() with the last state that save() has received before the interruption, if there is one.
    std::function<void(const Read&)> load = [](const Read&) {};
    /// Receives the state of a long part at intervals, as bytes of World::to_bytes().
    std::function<void(const std::string&)> save = [](const std::string&) {};
};

struct ValidationOptions {
    /// All parameter values of the dissertation; otherwise a selection that takes less time
    bool full = false;
    Device device = {};                                    ///< device of all worlds
    ValidationWarnings* warnings = nullptr;                ///< receives the warnings of all worlds
    std::function<void(double)> progress = [](double) {};  ///< called with the completed fraction, in [0, 1]
    /// Called at the start of a validation that takes more than some minutes, with a line that says how long
    std::function<void(const std::string&)> announce = [](const std::string&) {};

    ValidationProgress kept = {};  ///< of an interrupted validation
    SettledBeds beds = {};         ///< settled beds of earlier runs

    /// Adds the warnings of a run at its end.
    void include(const std::string& run, const World& world) const
    {
        if (warnings != nullptr) warnings->include(run, world.watch());
    }
};

/// A table with named columns. The first table of a result is written to study.csv, each other one to
/// NAME.csv.
struct ValidationTable {
    using Cell = std::variant<std::string, double>;

    std::string name;  ///< name of the file without .csv
    std::vector<std::string> columns;
    std::vector<std::vector<Cell>> rows;
};

/// The other bound of a check with one bound
inline constexpr double no_bound = 1e3;

/// An acceptance criterion: a measured value and its bounds. NaN is not within any bounds.
struct ValidationCheck {
    std::string what;
    double measured = 0, lower = 0, upper = 0;

    bool passed() const { return measured >= lower && measured <= upper; }
};

/// Maximum and minimum that propagate NaN: the result is NaN if a or b is NaN. std::max and std::min ignore
/// it, so that the check of a failed run would pass.
inline double max_or_nan(double a, double b) { return a != a || b <= a ? a : b; }
inline double min_or_nan(double a, double b) { return a != a || b >= a ? a : b; }

struct ValidationResult {
    std::vector<ValidationTable> tables;
    std::vector<ValidationCheck> checks;
};

/// A file registers a validation by io::Registry<Validation>::add.
struct Validation {
    std::string name;         ///< for example head-on
    std::string description;  ///< what is validated, with the figure, in one line
    ValidationResult (*run)(const ValidationOptions&) = nullptr;
    bool independent_parts = false;  ///< whether its simulations are those of ValidationProgress::parts
};

}  // namespace hilda::granular
