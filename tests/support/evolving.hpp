// SPDX-License-Identifier: GPL-3.0-or-later
/// Support for tests of evolving contacts: surface pairs, contact poses, models and runs.
#pragma once

#include "contact/evolving/contact.hpp"
#include "contact/surfaces/cylinder.hpp"
#include "contact/surfaces/ellipsoid.hpp"
#include "contact/surfaces/plane.hpp"
#include "contact/surfaces/sphere.hpp"
#include "contact/surfaces/superquadric.hpp"
#include "contact/surfaces/torus.hpp"
#include "contact/tangent_basis.hpp"
#include "dae/model.hpp"
#include "dae/start.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "lie/settings.hpp"
#include "lie/solver/linear_solver.hpp"
#include "lie/solver/saddle.hpp"
#include "lie/trajectory.hpp"
#include "tests/support/random_motion.hpp"

#include <Eigen/SVD>

#include <functional>

namespace hilda::tests {

using contact::EvolvingContact;
using Friction = contact::EvolvingContact::Friction;
using NormalRows = contact::EvolvingContact::NormalRows;
using contact::Shape;
using lie::Mat3;
using lie::Motion;
using lie::Vec3;

template <class S, class... Arguments>
Shape shape(Arguments&&... arguments)
{
    return {std::make_shared<S>(std::forward<Arguments>(arguments)...)};
}

/// The same surface with a random pose in its body
inline Shape moved(Shape shape, Random& random)
{
    shape.position = random.vector(0.3);
    shape.orientation = random.rotation();
    return shape;
}

/// A pair of surfaces and the regions in which random contact points are chosen
struct SurfacePair {
    std::string name;
    Shape i, j;
    /// Centre and half-width of the region of the contact point, in the surface frame [m]
    Vec3 near_i, near_j;
    double spread_i = 0.5, spread_j = 0.5;
};

/// All types of surface, convex and concave, on either body, each with a random pose in its body
inline std::vector<SurfacePair> surface_pairs(Random& random)
{
    using namespace contact;
    const Vec3 up = Vec3::UnitZ(), out = Vec3::UnitX();
    std::vector<SurfacePair> all{
        {"ball in an ellipsoidal bowl", shape<Sphere>(0.5), shape<Ellipsoid>(Vec3(4, 3, 2), true), up,
         Vec3(1, 1.5, -1.6), 0.5, 0.4},
        {"ellipsoid in a bowl", shape<Ellipsoid>(Vec3(0.5, 0.4, 0.3)), shape<Sphere>(2.0, true), 0.5 * up,
         -2 * up},
        {"two ellipsoids", shape<Ellipsoid>(Vec3(0.5, 0.7, 0.9)), shape<Ellipsoid>(Vec3(1.2, 0.8, 0.6)), up,
         out},
        {"ellipsoid on a plane", shape<Ellipsoid>(Vec3(0.3, 0.25, 0.15)), shape<Plane>(), 0.2 * up,
         Vec3::Zero()},
        {"plane on a superquadric", shape<Plane>(), shape<Superquadric>(Vec3(0.6, 0.5, 0.7), 2.5, 3.0),
         Vec3::Zero(), Vec3(0.5, 0.4, 0.6), 0.5, 0.1},
        {"superquadric and ball", shape<Superquadric>(Vec3(0.6, 0.5, 0.7), 4.0), shape<Sphere>(0.3),
         Vec3(0.5, 0.4, 0.6), up, 0.1, 0.5},
        {"ball on a cylinder", shape<Sphere>(0.4), shape<Cylinder>(0.7), up, out},
        {"ball in a pipe", shape<Sphere>(0.4), shape<Cylinder>(2.0, true), up, 2 * out},
        {"ellipsoid and cylinder", shape<Ellipsoid>(Vec3(0.3, 0.5, 0.4)), shape<Cylinder>(0.7), up, out},
        {"torus and ellipsoid", shape<Torus>(1.0, 0.3), shape<Ellipsoid>(Vec3(0.5, 0.7, 0.9)),
         Vec3(1.3, 0, 0.05), up, 0.15, 0.5},
        {"ball in a toroidal groove", shape<Sphere>(0.2), shape<Torus>(2.0, 0.6, true), up, Vec3(2, 0, -0.6),
         0.5, 0.3},
    };
    for (SurfacePair& pair : all) pair.i = moved(pair.i, random), pair.j = moved(pair.j, random);
    return all;
}

/// A random point of the surface near `near`, in the body frame
inline Vec3 point(const Shape& shape, const Vec3& near, double spread, Random& random)
{
    return shape.to_body(shape.surface->project(near + random.vector(spread)));
}

/// Two bodies in contact, with the contact points and a tangent basis
struct ContactPose {
    Motion bi, bj;
    Eigen::Matrix<double, 6, 1> alpha;
    EvolvingContact::NodeState node = {};  ///< node.T: tangent basis of the normal of i

    dae::Constraint::Arguments at() const
    {
        return {bi, bj, 0, alpha.data(), reinterpret_cast<const double*>(&node), false};
    }
};

/// Moves body i so that the given points of the two bodies are in contact; turned by `angle` about the normal
inline void place_in_contact(const Shape& shape_i, const Vec3& a_i, Motion& bi, const Shape& shape_j,
                             const Vec3& a_j, const Motion& bj, double angle = 0)
{
    const auto frame = [](const Vec3& n) {
        Mat3 A;
        A << contact::tangent_basis(n), n;
        return A;
    };
    const auto normal = [](const Shape& shape, const Vec3& a) {
        return Vec3(shape.orientation * shape.surface->normal(shape.to_surface(a)));
    };
    const Vec3 n = bj.A * normal(shape_j, a_j);
    bi.A = lie::orthonormalised(frame(-n) * lie::exp(angle * Vec3::UnitZ()) *
                                frame(normal(shape_i, a_i)).transpose());
    bi.r = bj.r + bj.A * a_j - bi.A * a_i;
}

inline ContactPose random_contact_pose(const SurfacePair& pair, Random& random)
{
    ContactPose x;
    x.bi = random.motion(), x.bj = random.motion();
    const Vec3 a_i = point(pair.i, pair.near_i, pair.spread_i, random),
               a_j = point(pair.j, pair.near_j, pair.spread_j, random);
    place_in_contact(pair.i, a_i, x.bi, pair.j, a_j, x.bj, random.number(-3, 3));
    x.alpha << a_i, a_j;
    const Vec3 n_i = x.bi.A * (pair.i.orientation * pair.i.surface->normal(pair.i.to_surface(a_i)));
    x.node.T = contact::tangent_basis(n_i);
    return x;
}

/// The k-th evolving contact of a model
inline const EvolvingContact& contact_of(const dae::Model& model, size_t k = 0)
{
    return static_cast<const EvolvingContact&>(*model.general_constraints()[k]);
}
inline EvolvingContact::Multipliers multipliers(const dae::Model& model, const lie::State& x, size_t k = 0)
{
    const EvolvingContact& c = contact_of(model, k);
    return c.multipliers(model.arguments(c, x), x.lambda);
}

/// Inertia of a homogeneous ellipsoid about its centre
inline Mat3 inertia(double m, const Vec3& semi_axes)
{
    const Vec3 squares = semi_axes.cwiseAbs2();
    return 0.2 * m * (Vec3::Constant(squares.sum()) - squares).asDiagonal().toDenseMatrix();
}

/// Condition number of the saddle matrix of one free body of mass m, with lengths scaled by L and masses by m
inline double condition(const dae::Model& model, const lie::State& x, double m, double L)
{
    lie::Saddle K(model);
    K.assemble(x);
    Eigen::MatrixXd written(K.size(), K.size());
    Eigen::VectorXd column(K.size());
    for (int c = 0; c < K.size(); ++c) {
        K.multiply(Eigen::VectorXd::Unit(K.size(), c), column);
        written.col(c) = column;
    }
    Eigen::VectorXd scale = Eigen::VectorXd::Constant(K.size(), 1 / std::sqrt(m));
    scale.segment<3>(3) /= L;
    K.constraint_part(scale).setConstant(std::sqrt(m));
    const Eigen::VectorXd singular =
        (scale.asDiagonal() * written * scale.asDiagonal()).eval().jacobiSvd().singularValues();
    return singular[0] / singular[singular.size() - 1];
}

/// A model with evolving contacts and its state
struct ContactModel {
    dae::Model model;
    lie::State x;

    void add(const std::string& name, double m, const Mat3& J_bar, const Motion& motion)
    {
        model.add({name, m, J_bar});
        x.body.push_back(motion);
    }
    void add_contact(const std::string& name, int i, const Shape& shape_i, int j, const Shape& shape_j,
                     Friction friction = Friction::none, NormalRows normal_rows = NormalRows::tangent)
    {
        model.constrain(name,
                        std::make_unique<EvolvingContact>(i, shape_i, j, shape_j, friction, normal_rows));
    }
    void start(bool fix_initial = false) { dae::start(model, x, {.fix_initial = fix_initial}); }
};

/// Calls a function at every node.
struct NodeCallback final : lie::Observer {
    explicit NodeCallback(std::function<void(const lie::State&, long)> f) : f(std::move(f)) {}
    void accepted(const lie::State& x, long n, int) override { f(x, n); }
    std::function<void(const lie::State&, long)> f;
};

/// Runs to t_end, calls `watch` at every node, and returns the last state
inline lie::State run(
    ContactModel& scene, const char* scheme, double h, double t_end,
    const std::function<void(const lie::State&, long)>& watch = [](const lie::State&, long) {},
    lie::LinearSolver solver = lie::LinearSolver::automatic)
{
    NodeCallback observer(watch);
    lie::Observer* observers[] = {&observer};
    const auto integrator =
        lie::scheme(scheme).make(scene.model, {.tolerance = 1e-14, .linear_solver = solver});
    return lie::march(scene.x, *integrator, lie::TimeGrid::over(t_end, h, t_end), observers).row.back();
}

inline const Vec3 bowl_axes(4, 3, 2);
inline constexpr double R = 0.5;

/// A ball of 1 kg in the ellipsoidal bowl, at rest, with its centre at r
struct BallInBowl : ContactModel {
    explicit BallInBowl(const Vec3& r, Friction friction = Friction::none, const Vec3& omega = Vec3::Zero(),
                        NormalRows normal_rows = NormalRows::tangent)
    {
        Motion ball;
        ball.r = r;
        ball.omega_bar = omega;
        add("ball", 1, 0.4 * R * R * Mat3::Identity(), ball);
        add_contact("bowl", 0, shape<contact::Sphere>(R), dae::ground,
                    shape<contact::Ellipsoid>(bowl_axes, true), friction, normal_rows);
        start();
    }
};

}  // namespace hilda::tests
