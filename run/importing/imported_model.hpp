// SPDX-License-Identifier: GPL-3.0-or-later
/// A mechanism read from a file of another program, in the form that its readers have in common.

#pragma once

#include "lie/so3.hpp"

#include <string>
#include <vector>

namespace hilda::run {

/// A joint of a body with its parent, in the initial configuration. All vectors are global.
struct ImportedJoint {
    enum Type { hinge, slide, ball, free };

    std::string name;
    Type type = hinge;
    lie::Vec3 anchor = lie::Vec3::Zero();  ///< [m]
    lie::Vec3 axis = lie::Vec3::UnitZ();   ///< of a hinge or slide
    double stiffness = 0, damping = 0;     ///< of a hinge or slide [N m/rad, N m s/rad or N/m, N s/m]
    double rest = 0;                       ///< coordinate without spring force [rad or m]; initially 0
};

struct ImportedBody {
    std::string name;
    int parent = -1;                      ///< index of an earlier body; -1: the ground
    double m = 0;                         ///< [kg]
    lie::Vec3 r = lie::Vec3::Zero();      ///< centre of mass [m], global
    lie::Mat3 A = lie::Mat3::Identity();  ///< of the body frame to be used
    lie::Mat3 J_bar = lie::Mat3::Zero();  ///< inertia about r [kg m²], in the body frame
    /// In the order from the parent to the body. None: the body is welded to its parent.
    std::vector<ImportedJoint> joints{};
};

/// A constraint that closes a loop
struct ImportedLoop {
    std::string name;
    bool is_weld = false;  ///< else the bodies have a common point
    int i = -1, j = -1;
    lie::Vec3 point = lie::Vec3::Zero();  ///< global [m]
};

struct ImportedModel {
    std::string name;
    lie::Vec3 gravity{0, 0, -9.81};  ///< [m/s²]
    std::vector<ImportedBody> bodies;
    std::vector<ImportedLoop> loops;
    /// Replace principal moments of inertia that violate the triangle inequality by their mean.
    bool balances_inertia = false;
    std::vector<std::string> warnings;  ///< what the model file does not have
};

/// The text of the model file. Welded bodies are added to their parents. Consecutive joints of a body become
/// a joint of HILDA: two perpendicular hinges with a common point a universal joint, three a spherical one,
/// a hinge and a slide on one line a cylindrical one, two slides and a hinge normal to them a planar one.
///
/// Throws io::InvalidInput "FILE: ..." for other combinations, for springs and dampers of joints without a
/// single axis, and for bodies that move and have no mass or inertia.
///
/// The key `note` lists the warnings. Those of more than 4000 bytes are counted by kind, "limits of joint
/// (45)".
std::string model_text(ImportedModel& from, const std::string& file);

/// A message about the model text: its place "PATH:LINE:COL (/bodies/3/mass)" in a file that is not written
/// is replaced by the body or joint, "body 'arm' (mass)". Other messages are returned as they are.
std::string message_about(const std::string& text, const std::string& message);

}  // namespace hilda::run
