// SPDX-License-Identifier: GPL-3.0-or-later
/// Snapshots as tables, from which figures are drawn (studies/plots/bodies.py).

#pragma once

#include "io/archive.hpp"
#include "run/frames/vtk.hpp"

#include <string>
#include <utility>
#include <vector>

namespace hilda::run {

/// The snapshots of one run as text: rows of two tables, without their headers, and an object of a JSON list.
///
///     poses.csv      run, body, t [s], shown (1: drawn as a snapshot, 0: part of a path only), position rx ry rz [m],
///                    rotation matrix A11 … A33, velocity vx vy vz [m/s]
///     contacts.csv   run, contact, t, shown, contact point Cx Cy Cz [m], first tangent ux uy uz of the contact frame (zero
///                    if it is not known), normal force Nx Ny Nz and friction force Fx Fy Fz on the first body [N]
///     shapes.json    run, the names of the bodies, and the meshes, joints and lines of Snapshots::geometry()
///
/// All vectors of the tables are global. Contacts have a row while they have a normal force.
struct SnapshotTables {
    std::string poses, contacts, shapes;

    void transfer(io::Archive& a) { a.list(poses), a.list(contacts), a.list(shapes); }
};

/// The tables of a run. `bodies` and `contacts` are names, by number; the frames nearest to the times `shown`
/// [s] are the snapshots.
SnapshotTables snapshot_tables(const Snapshots& snapshots, const std::string& run,
                               const std::vector<std::string>& bodies,
                               const std::vector<std::string>& contacts, const std::vector<double>& shown);

/// Names and contents of the files PREFIXposes.csv, PREFIXcontacts.csv and PREFIXshapes.json. Runs without
/// frames are left out, and the contacts if there are none.
std::vector<std::pair<std::string, std::string>> snapshot_files(const std::string& prefix,
                                                                const std::vector<SnapshotTables>& runs);

}  // namespace hilda::run
