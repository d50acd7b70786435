// SPDX-License-Identifier: GPL-3.0-or-later
/// Prescribes the motion of joints and drivers of a model by the columns of a CSV file.

#pragma once

#include "dae/model_file.hpp"

#include <string>

namespace hilda::run {

/// The model with a motion for each column of the file but t [s]. A column has the name of
///
/// - a driver: its function of time becomes that of the column;
/// - a revolute joint: a hinge driver is added, whose angle from the start is the change of the column [rad];
/// - a translational joint: the distance of its points along its axis changes by that of the column [m].
///
/// The added drivers have the name "NAME drive". Between the samples the motion is a quintic spline
/// (dae::SampledCurve). io::InvalidInput and lie::InvalidInput for another name, and for invalid samples,
/// with the place.
dae::Description with_motion(const dae::Description& model, const std::string& file);

}  // namespace hilda::run
