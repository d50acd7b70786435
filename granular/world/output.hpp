// SPDX-License-Identifier: GPL-3.0-or-later
/// Output of a world: tables (CSV) and frames for ParaView (VTK).

#pragma once

#include "granular/world/world.hpp"
#include "io/files.hpp"

namespace hilda::granular {

class Groups;

/// One line per particle, ordered by id: id,material,radius,x,y,z,vx,vy,vz,omega_x,omega_y,omega_z, and
/// e0,e1,e2,e3 if the world integrates orientations, and clump if it has templates of clumps: the id of the
/// first particle of the clump, -1 without a clump. SI units, global frame.
std::string particles_csv(const World& world);
/// The same in pieces of about 1 MiB. With `groups` there is the column group, -1 for particles without one.
void particles_csv(const World& world, const io::Append& append, const Groups* groups = nullptr);
/// One line per clump: id of its first particle, spheres, shape (number of the template), mass, scale, centre
/// of mass, velocities, Euler parameters from the frame of the template, angular momentum
void clumps_csv(const World& world, const io::Append& append);
/// One line per contact: i,j,boundary,nx,ny,nz,overlap,Fx,Fy,Fz,ux,uy,uz. See ContactRecord.
void contacts_csv(const World& world, const io::Append& append);
/// The particles as points with radius, velocity, angular velocity, material, id and, if integrated,
/// orientation, and with `groups` group. VTK XML PolyData with raw appended data, in pieces.
void particles_vtp(const World& world, const io::Append& append, const Groups* groups = nullptr);

/// Love-Weber stress of the contacts over a volume V [m³]:
///
///     σ = 1/V Σ l ⊗ F
///
/// l is the branch vector from the centre of mass of j, or from the contact point on a boundary, to that of
/// i; F is the force on i. Returns the 9 components by rows [Pa]; compression is positive.
std::array<double, 9> stress(const World& world, const std::vector<ContactRecord>& contacts, double volume);

}  // namespace hilda::granular
