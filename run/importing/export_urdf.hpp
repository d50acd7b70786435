// SPDX-License-Identifier: GPL-3.0-or-later
/// Export of models as URDF files.

#pragma once

#include <string>
#include <vector>

namespace hilda::dae {
struct Description;
}

namespace hilda::run {

/// The URDF text of a model whose bodies form a tree of revolute, translational and fixed joints, with the
/// ground (the link `world`) or free bodies as roots, in its initial configuration. The frame of a link is at
/// its joint, parallel to the frame of the body. Dampers about a revolute joint become its damping.
/// `left_out` receives what URDF has not: other forces, contacts, gravity other than 9.81 m/s² along -z,
/// initial velocities.
///
/// Throws io::InvalidInput "NAME: ..." for loops and for other constraints.
std::string urdf_text(const dae::Description& model, std::vector<std::string>& left_out);

struct ExportOptions {
    std::string model;         ///< name of a built-in model, or path of a model file
    std::string output;        ///< the URDF file; empty: NAME.urdf
    bool force = false;        ///< replace `output`
    bool allow_paths = false;  ///< files that the model names need not be below its folder
};

/// Writes the file and prints its name. Returns the exit code. Throws what urdf_text() throws, io::IoError.
int export_model(const ExportOptions& options);

}  // namespace hilda::run
