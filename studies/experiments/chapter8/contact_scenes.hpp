// SPDX-License-Identifier: GPL-3.0-or-later
/// Scenes with many contacts for the comparison of contact methods (Fang 2022, Sec. 8.2): a pile of balls in
/// a bowl and a chain of rolling balls.

#pragma once

#include "contact/scenes/scene.hpp"

namespace hilda::studies {

/// Description of a scene, independent of the contact method: body types, bodies, and the type pairs in
/// contact.
struct ContactScene {
    struct Body {
        int type;
        lie::Motion start;
    };
    /// Contact law of two body types; pairs of types without an interaction do not collide.
    struct Interaction {
        std::string name;
        int type_i, type_j;
        double mu;
    };

    lie::Vec3 gravity = {0, 0, -9.81};  ///< [m/s²]
    std::vector<contact::BodyType> body_types;
    std::vector<Body> body;
    std::vector<Interaction> interaction;
    double R = 0;  ///< of a ball [m]
    double m = 0;  ///< of a ball [kg]
};

/// Balls that fall and come to rest in an ellipsoidal bowl with semi-axes in the ratio 4 : 3 : 2. At the
/// start the balls are arranged in layers without contact, filled from the bottom; the volume of the bowl is
/// about three times the volume that they occupy.
struct Pile {
    int balls = 100;
    double mu = 0.3;        ///< friction coefficient, ball-ball and ball-bowl
    double R = 0.1, m = 1;  ///< [m, kg]
};
/// Body 0 is the fixed bowl; the other bodies are the balls. InvalidInput for less than one ball or a radius
/// or mass that is not positive.
ContactScene scene(const Pile& pile);

/// A row of balls in contact with each other and with the two walls of a groove along x (three contacts per
/// ball).
///
/// With speed > 0 the balls roll up the slope, pushed by a ball that moves at constant speed without
/// rotation. With speed 0 they roll down the slope from rest.
///
/// Let ρ = R cos 50° be the distance of the centre of a ball from the line through its two wall contacts, and
/// c = μ R/ρ. Each pushed ball slides on both neighbours, and the walls supply the traction. The force
/// between neighbours is
///
///     P_k = (m g sin α + (1 + c) P_{k+1})/(1 - c),     P_{N+1} = 0 for N balls
///
/// Without the pushing ball all balls have the acceleration g sin α/(1 + 0.4 R²/ρ²).
struct RollingChain {
    int balls = 10;
    double slope = 0.1;     ///< α [rad]
    double speed = 0.5;     ///< [m/s]
    double mu_between = 0;  ///< friction coefficient, ball-ball
    double mu_wall = 0.6;   ///< friction coefficient, ball-wall
    double R = 0.1, m = 1;  ///< [m, kg]

    static constexpr double wall =
        50 * 3.14159265358979323846 / 180;  ///< angle of each wall from the horizontal [rad]
    double rho() const { return R * std::cos(wall); }
    /// P_1 [N], the force between the pushing ball and the first ball
    double push() const;
};
/// Bodies 0 and 1 are the left and the right wall; the balls follow from the rear to the front. The last body
/// is the pushing ball if speed > 0. InvalidInput for less than one ball or a radius or mass that is not
/// positive.
ContactScene scene(const RollingChain& chain);

/// Pairs of bodies with a gap below `gap` [m] at the start, for methods with a fixed set of contacts
std::vector<contact::Candidate> contact_pairs(const ContactScene& setup, double gap);

/// Compliant contacts: linear normal springs, friction law slide-roll-spin without rolling resistance
struct Compliance {
    double stiffness = 1e6;  ///< normal and tangential contact stiffness [N/m]
    /// Coefficient of restitution of a ball and a fixed body; it is smaller for two balls, whose damping is
    /// the same and whose effective mass is m/2
    double restitution = 0.2;
};
contact::Scene compliant(const ContactScene& setup, const Compliance& compliance);

}  // namespace hilda::studies
