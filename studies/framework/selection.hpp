// SPDX-License-Identifier: GPL-3.0-or-later
/// Integrators and steps of a study: those of the command line, or the defaults of the study.

#pragma once

#include "lie/schemes.hpp"
#include "studies/framework/study.hpp"

namespace hilda::studies {

using Schemes = std::vector<const lie::Scheme*>;

/// The integrators of --integrator; without it those of `defaults` that are registered, in this order, or all
/// if `defaults` is empty
Schemes any_schemes(const StudyOptions& options, const std::vector<std::string>& defaults = {});

/// The same, restricted to schemes with a fixed step. io::UsageError if --integrator names an adaptive scheme.
Schemes fixed_step_schemes(const std::string& kind, const StudyOptions& options,
                           const std::vector<std::string>& defaults = {});

/// The steps of --steps, or `defaults`, in descending order [s]
std::vector<double> steps_or(const StudyOptions& options, const std::vector<double>& defaults);

/// The step of --steps, or the default [s]. io::UsageError for more than one step.
double one_step(const std::string& kind, const StudyOptions& options, double defaults);

/// io::UsageError if --vtk is given and no output directory
void check_vtk(const std::string& kind, const StudyOptions& options);

/// io::UsageError if --problem, --integrator or --set is given, for studies that define their own bodies
void refuse_models(const std::string& kind, const StudyOptions& options);
/// io::UsageError if --integrator or --set is given, for studies in which --problem selects a case of the study
void refuse_schemes(const std::string& kind, const StudyOptions& options);

}  // namespace hilda::studies
