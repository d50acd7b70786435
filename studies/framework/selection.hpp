// SPDX-License-Identifier: GPL-3.0-or-later
/// Schemes and steps of a study: those the user named, or else its own.

#pragma once

#include "studies/framework/study.hpp"

namespace hilda::studies {

using Schemes = std::vector<const lie::Scheme*>;

/// Those of --integrator, or else those of `otherwise` that are there, in this order; all when it is empty.
Schemes any_schemes(const StudyOptions& options, const std::vector<std::string>& otherwise = {});

/// The same of schemes with a fixed step; UsageError when another is named.
Schemes fixed_step_schemes(const std::string& kind, const StudyOptions& options,
                           const std::vector<std::string>& otherwise = {});

/// --steps, or else these; the largest first
std::vector<double> steps_or(const StudyOptions& options, std::vector<double> otherwise);

/// The one of --steps, or else this; UsageError for several.
double one_step(const std::string& kind, const StudyOptions& options, double otherwise);

/// UsageError where --vtk has nowhere to write to.
void check_vtk(const std::string& kind, const StudyOptions& options);

/// UsageError where a model, an integrator or a setting of a model is named: the study has bodies of its own.
void refuse_models(const std::string& kind, const StudyOptions& options);
/// The same where --problem has a meaning of its own
void refuse_schemes(const std::string& kind, const StudyOptions& options);

}  // namespace hilda::studies
