// SPDX-License-Identifier: GPL-3.0-or-later
/// What a run leaves: tables for plots, particles for ParaView.

#pragma once

#include "granular/world/world.hpp"

namespace hilda::granular {

/// id,material,radius,x,y,z,vx,vy,vz,omega_x,omega_y,omega_z: a line a particle, by id
std::string particles_csv(const World& world);
/// i,j,boundary,nx,ny,nz,overlap,Fx,Fy,Fz,ux,uy,uz: a line a contact
std::string contacts_csv(const World& world);
/// Particles as points with radius, velocity, angular velocity, material and id (VTK XML PolyData, raw appended)
std::string particles_vtp(const World& world);
/// The collection of a run: times and files
std::string pvd(const std::vector<std::pair<double, std::string>>& frames);

/// The Love-Weber stress of the contacts over a volume [Pa]: σ = 1/V Σ l ⊗ F, pressure positive; row by row
std::array<double, 9> stress(const World& world, const std::vector<ContactRecord>& contacts, double volume);

}  // namespace hilda::granular
