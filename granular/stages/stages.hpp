// SPDX-License-Identifier: GPL-3.0-or-later
/// The stages of a run: each changes parameters of the case at its start and ends at a time or when the
/// particles are at rest.

#pragma once

#include "granular/stages/case_parameters.hpp"

namespace hilda::granular {

/// A stage has reached its largest duration and its condition is not met (stage_timeout), or a boundary is
/// not at the place where its formula in the next stage begins (stage_motion).
class StageFailed : public io::NumericalFailure {
public:
    using NumericalFailure::NumericalFailure;
};

/// What is decided is a function of the state of the world between two steps, so that neither rows nor
/// interruptions change it.
class Stages {
public:
    /// Reads the parameters of all stages of a case. Throws io::PlacedError with the place of the stage.
    Stages(const Case& c, const Environment& environment);

    /// Receives a warning with its name: stage_timeout of a condition that is not met in time, stage_end of a
    /// stage that has no steps because its end is past, stage_remove and stage_groups of a stage that
    /// removes, or assigns to a group, no particle.
    using Warn = std::function<void(const char* name, const std::string& text)>;

    /// Begins the first stage, at the initial state.
    void begin_run(Case& c, const Warn& warn);
    /// Ends the present stage before a step if it is over, and begins the next one. Throws StageFailed.
    void update(Case& c, const Warn& warn);
    /// After the last step of the run: as update() if the present stage has a condition that is not met.
    void end_run(const World& w, const Warn& warn);
    /// Whether the last stage is over, and with it the run
    bool have_ended() const { return is_over; }
    /// Whether no further step is possible at the present instant, with any end of the run
    bool have_no_step_left(const World& w) const { return is_over || (is_last() && is_late(w)); }
    long number() const { return static_cast<long>(log.size()) - 1; }  ///< of the present stage
    const StageSpec& what() const { return spec[log.size() - 1]; }
    bool is_last() const { return log.size() == spec.size(); }

    /// Calls f(JSON pointer, limits of the step with the laws of the stage) for each stage that sets laws.
    void each_step_limit(World& w,
                         const std::function<void(const std::string&, const World::StepLimits&)>& f) const;
    /// Boundaries that move in a stage
    std::vector<int> moving() const;

    /// Writes or reads the state.
    void transfer(io::Archive& a);
    /// After transfer() has read: gives the world the parameters of the present stage.
    void resume(Case& c) const;
    /// Start, end and the reason of the end of each stage that has begun
    io::Json summary(double t) const;

private:
    enum Reason : std::int64_t { running, condition, duration };
    struct Part {
        std::int64_t start = 0, end = 0;  ///< [steps]
        std::int64_t reason = running;
        std::int64_t removed = 0;  ///< particles, at the start
    };
    /// What a stage sets
    struct Change {
        std::vector<std::string> pointers;  ///< none: it sets nothing
        CaseParameters to;
    };

    static Change read_change(const Case& c, io::JsonSource& source, const StageSpec& s,
                              const Environment& environment);
    void begin(Case& c);
    void select(Case& c);
    void report_selections(const World& w, const Warn& warn) const;
    bool is_at_rest(const World& w);
    bool is_late(const World& w) const;
    void check_ends(const Case& c) const;
    void report_condition(const World& w, const Warn& warn) const;
    long steps_in(double time) const;

    std::vector<StageSpec> spec;
    std::vector<Change> changes;
    double h;  ///< [s]
    std::vector<Part> log;
    double largest_energy = 0;   ///< kinetic, of the present stage [J]
    std::optional<bool> is_met;  ///< whether the condition of the present stage was met at its end
    bool is_over = false;
    std::vector<std::string> without_particles;  ///< groups to which the present stage has assigned none
};

}  // namespace hilda::granular
