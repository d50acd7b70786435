// SPDX-License-Identifier: GPL-3.0-or-later
/// The exchange of motions and impulses between a mechanism and grains.                 Fang (2022), Sec. 6.3
///
/// The mechanism has the step H, the grains the step h = H/k. The mechanism is integrated by a leapfrog: its
/// momenta belong to the middles of its steps. The loads F_j and T_j of the grains at the instants
///
///     t_n + j h,    -k/2 ≤ j ≤ k/2                                      around the node t_n = n H
///
/// are summed to the impulses  P_n = Σ h F_j  and  L_n = Σ h T_j,  which the momenta of the mechanism receive
/// at t_n. With an even k the nodes n and n + 1 share the instant t_n + k h/2: each receives half of its
/// impulse. Without this the instants would be h/2 after the node on average, and a spring would gain energy
/// at a rate that does not decrease with H. Both sides receive opposite impulses, for any k. At these
/// instants a tool moves with the velocities that the mechanism has half a step before t_n, through its place
/// at t_n. The order is serial: a step of the mechanism follows k steps of the grains, without a lag. At the
/// start the grains compute the instants from j = 0 on.

#pragma once

#include "granular/core/boundary.hpp"

#include <string>
#include <vector>

namespace hilda::granular {

/// Place and velocities of a tool, in the global frame
struct ToolMotion {
    Vec3 r = {0, 0, 0};                          ///< Boundary::r [m]
    EulerParameters<double> p = {1, {0, 0, 0}};  ///< Boundary::p
    Vec3 v = {0, 0, 0}, omega = {0, 0, 0};       ///< of r [m/s], [rad/s]
};

/// Impulses of the grains on a tool, in the global frame
struct ToolImpulse {
    Vec3 P = {0, 0, 0};  ///< [N s]
    Vec3 L = {0, 0, 0};  ///< about the centre of mass of the body [N m s]
    double work = 0;     ///< of the loads, with the velocities of the tool in the steps of the grains [J]
    Vec3 P_last = {0, 0, 0}, L_last = {0, 0, 0};  ///< the parts of the last step
};

/// A boundary that a body of the mechanism moves
struct Tool {
    std::string name;  ///< of the boundary
    double mass = 0;   ///< of the case [kg]; 0: none
    ToolMotion place;  ///< at the start of the case
};

/// The body of a tool
struct ToolBody {
    double mass = 0;          ///< [kg]
    Vec3 centre = {0, 0, 0};  ///< centre of mass relative to Boundary::r, in the frame of Boundary::p [m]
};

/// Stiffness of the contacts of a tool
struct ToolStiffness {
    double present = 0;  ///< sum of the present contacts [N/m]
    double single = 0;   ///< largest of a contact with the overlap single_overlap [N/m]

    static constexpr double single_overlap = 1e-3;  ///< over the radius of the grain
};

/// The grains of a co-simulation, as the mechanism sees them. The functions throw io::NumericalFailure.
class Exchange {
public:
    virtual ~Exchange() = default;

    virtual double h() const = 0;                        ///< step of the grains [s]
    virtual const std::vector<Tool>& tools() const = 0;  ///< in the order in which they were named

    /// Begins the run of the grains, or restores the checkpoint with this number of steps if it is resumed.
    /// No file is written before. To be called once, before the functions below.
    virtual void open(const std::vector<ToolBody>& bodies, long steps) = 0;
    /// Loads on the tools at these places at the present instant, in place of impulses [N, N m]
    virtual std::vector<ToolImpulse> loads(const std::vector<ToolMotion>& motions) = 0;
    /// Moves the tools from these places with these velocities and computes `number` steps. The velocities
    /// are constant in these steps. The impulses are written to `to`.
    virtual void advance(const std::vector<ToolMotion>& motions, long number,
                         std::vector<ToolImpulse>& to) = 0;
    virtual void stiffness(std::vector<ToolStiffness>& to) = 0;  ///< of the present contacts
    /// Writes a checkpoint of the grains.
    virtual void save() = 0;
    /// Ends the run of the grains and writes its outputs, with this exit code in its summary.
    virtual void close(int code) = 0;
};

}  // namespace hilda::granular
