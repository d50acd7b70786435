// SPDX-License-Identifier: GPL-3.0-or-later
/// Scenes of many contacts for the comparison of contact methods: a pile of balls in a bowl, a chain of balls that roll.

#pragma once

#include "contact/scenes/dvi/dvi_scene.hpp"
#include "contact/scenes/scene.hpp"

namespace hilda::studies {

/// What a scene is, whatever steps it
struct ContactScene {
    struct Body {
        int kind;
        lie::Motion start;
    };
    /// Two kinds that touch each other
    struct Interaction {
        std::string name;
        int kind_i, kind_j;
        double mu;
    };

    lie::Vec3 gravity = {0, 0, -9.81};  ///< [m/s²]
    std::vector<contact::BodyType> kind;
    std::vector<Body> body;
    std::vector<Interaction> interaction;
    double R = 0;  ///< of a ball [m]
    double m = 0;  ///< of a ball [kg]
};

/// Balls that fall a little and come to rest in the bowl of an ellipsoid with semi-axes in the ratio 4 : 3 : 2. At the
/// start they stand in layers without touching, the lowest that have room, in a bowl of about three times their volume.
struct Pile {
    int balls = 100;
    double mu = 0.3;        ///< between balls, and with the bowl
    double R = 0.1, m = 1;  ///< [m, kg]
};
/// Body 0 is the bowl, fixed; the others are the balls.
ContactScene scene(const Pile& pile);

/// Balls in a row that touch each other, and the two walls of a groove along x: three contacts a ball. They begin to roll
/// up a slope at a given speed, pushed from behind by a ball that keeps that speed and does not turn, or, at speed zero,
/// from rest down the slope by their weight.
///
/// With c = μ R/ρ, ρ = R cos 50° the distance of a ball's centre from the line through its two wall contacts, rolling balls
/// that are pushed press on each other with P_k, the last one on nothing:
///
///     P_k = (m g sin α + (1 + c) P_{k+1})/(1 - c)
///
/// as each ball slides on both neighbours, which needs traction of the walls. Freely they go with g sin α/(1 + 0.4 R²/ρ²)
/// as one.
struct RollingChain {
    int balls = 10;
    double slope = 0.1;     ///< α [rad]
    double speed = 0.5;     ///< [m/s]
    double mu_between = 0;  ///< of ball on ball
    double mu_wall = 0.6;
    double R = 0.1, m = 1;  ///< [m, kg]

    static constexpr double wall =
        50 * 3.14159265358979323846 / 180;  ///< angle of each wall from the level [rad]
    double rho() const { return R * std::cos(wall); }
    /// P_1 [N], with the ball that pushes, or on it
    double push() const;
};
/// Bodies 0 and 1 are the walls, left and right of x; then come the balls, from the hindmost on; the last one is the ball
/// that pushes, if there is one.
ContactScene scene(const RollingChain& chain);

/// Pairs of bodies that touch at the start, to a gap [m]; for methods that are told their contacts
std::vector<contact::Candidate> touching(const ContactScene& of, double gap);

/// Rigid, as a differential variational inequality. crowd.margin is R/5.
contact::DviScene rigid(const ContactScene& of);

/// Compliant: linear springs, friction by slide-roll-spin without rolling resistance
struct Compliance {
    double stiffness = 1e6;    ///< of a contact [N/m], and of its friction
    double restitution = 0.2;  ///< of two balls
};
contact::Scene compliant(const ContactScene& of, const Compliance& how);

}  // namespace hilda::studies
