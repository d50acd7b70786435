// SPDX-License-Identifier: GPL-3.0-or-later
/// The command hilda-granular export --lammps: a case as an input file and a data file of LAMMPS, of 29 Sep
/// 2021 or later. See lammps_laws.hpp for the laws.
///
///     HILDA                              LAMMPS
///     domain, periodic, lost             boundary p or f, the box of data.lammps, thermo_modify lost
///     integrator velocity-verlet         fix nve/sphere: the same scheme. Both evaluate the contact forces
///                                        with the velocities of the middle of the step.
///     integrator symplectic-euler        fix nve/sphere: v_n of HILDA is that of the middle of the step
///                                        before t_n. The trajectories differ by the first half kick.
///     plane, box                         region plane, fix wall/gran/region
///     cylinder along x, y or z, sphere   region cylinder or sphere: R* = R/(1 + κ R) with the same κ
///     fixed                              fix freeze: m* is the mass of the other particle in both
///     gravity, step, end                 fix gravity, timestep, run
///     interval, frame_interval           fix print: lammps.csv with columns of run.csv; dump: frames.lammpstrj
///
/// The particles are those of the first instant of a run, with all digits. Their ids in LAMMPS are one
/// higher. What acts on the motion and has no counterpart is refused with its place in the case: other laws,
/// motions, meshes, finite surfaces, tools, clumps, replicas, insertions, stages, forces on particles.
/// Fields, lists of contacts and groups are outputs and are left out.
///
/// LAMMPS writes the contact forces of an instant with the velocities of the middle of the step before it,
/// run.csv has those with the velocities of the instant: a difference of first order in h.

#pragma once

#include "granular/case/case_file.hpp"

#include <string>

namespace hilda::granular {

/// Writes in.lammps and data.lammps to a directory, which is made if it does not exist. The particles of the
/// case have been inserted. Throws io::PlacedError for what cannot be exported, and io::IoError.
void export_lammps(const Case& c, const std::string& directory);

}  // namespace hilda::granular
