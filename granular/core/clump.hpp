// SPDX-License-Identifier: GPL-3.0-or-later
/// Clumps: spheres that move as one rigid body.
///
/// The spheres of a clump, its members, are particles of the arrays. Contacts see only the members; there are
/// no pairs of members of the same clump. The velocity, the angular momentum and the pose of the body are
/// stored in ClumpBody, from which the members are placed after each step.
///
///     m v' = F,    L' = T + Σ d_i × F_i,    L = A J̄ Aᵀ ω,    d_i = A X_i
///
/// J̄ = diag(J_1, J_2, J_3): principal moments of inertia about the centre of mass. The state of the rotation
/// is w = L/J with J = 2/5 m R², where R is chosen such that J is the mean of the principal moments:
///
///     w' = T/J,    ω = w + A diag(J/J_k - 1) Aᵀ w
///
/// A particle has the same equations with ω = w. advance_particle() therefore integrates both, and a clump of
/// one sphere has the bits of a particle.
///
/// The orientation is advanced by the step of rigid_body.hpp with the angular momentum L that the scheme has
/// for the step: L = A_n J_r(θ̄)⁻¹ J̄ θ̄/h, A_{n+1} = A_n exp(θ̄). A rotation does not change L, which is
/// kept to rounding. The step is of order 2.                                          Hante and Arnold (2021)

#pragma once

#include "granular/core/boundary.hpp"
#include "granular/core/integrator.hpp"
#include "granular/core/neighbours/cells.hpp"

#include <vector>

namespace hilda::granular {

/// A sphere of a shape
struct ClumpSphere {
    Vec3 X;           ///< centre relative to the centre of mass, in the principal frame [m]
    double radius;    ///< [m]
    double fraction;  ///< of the sum of the volumes of all spheres
};

/// The shape of a clump. `extra` and `reach` are zero for a single sphere.
struct ClumpShape {
    std::uint32_t first, count;    ///< its spheres
    Vec3 extra;                    ///< J/J_k - 1, k = 1, 2, 3
    double reach;                  ///< largest |X| [m]
    EulerParameters<double> axes;  ///< from the principal frame to the frame of the template

    HILDA_HD bool is_isotropic() const { return extra.x == 0 && extra.y == 0 && extra.z == 0; }
};

/// State of a clump. No padding: checkpoints store the bytes.
struct ClumpBody {
    Position position = {};          ///< centre of mass
    Float4 velocity = {};            ///< v [m/s]; w: R [m]
    Float4 momentum = {};            ///< w = L/J [rad/s]; w: 1/m [1/kg]
    Float4 omega_before = {};        ///< ω before the last update of L [rad/s]; for kinetic energies
    Compensation compensation = {};  ///< of position, velocity and momentum
    Float4 acc = {}, alpha = {};     ///< of the previous step
    EulerParameters<double> p = {1, {0, 0, 0}};  ///< from the principal frame to the global frame
    double scale = 1;                            ///< of the lengths of the shape
    std::uint32_t first_id = 0;                  ///< of the first member; the others have the next ids
    std::uint16_t shape = 0;                     ///< its number
    std::uint16_t replica = 0;
};

/// What does not change from step to step
struct ClumpTables {
    std::vector<ClumpShape> shape;
    std::vector<ClumpSphere> sphere;
    std::vector<std::uint32_t> of;  ///< number of the clump by particle id, or no_clump
    double reach = 0;               ///< largest distance of a member from its centre of mass [m]
};

/// The clumps of the particles
struct ClumpView {
    const std::uint32_t* of =
        nullptr;  ///< number of the clump by particle id, or no_clump; nullptr: no clumps
    const std::uint32_t* id = nullptr;  ///< by particle
    const ClumpBody* body = nullptr;

    /// The number of the clump of a particle
    HILDA_HD std::uint32_t operator()(std::uint32_t k) const { return of == nullptr ? no_clump : of[id[k]]; }
    /// Whether a particle of this clump represents it in sums over particles
    HILDA_HD bool represents(std::uint32_t k, std::uint32_t clump) const
    {
        return body[clump].first_id == id[k];
    }
};

/// v or w of a clump with the rounding error [m/s, rad/s]
HILDA_HD inline Vec3 with_error(const Float4& x, const std::uint16_t* error)
{
    const Vec<float> e = load_bfloat16(error);
    return to_double(x) + Vec3{e.x, e.y, e.z};
}

/// A diag(s) Aᵀ x
HILDA_HD inline Vec3 scaled_in_frame(const EulerParameters<double>& p, const Vec3& s, const Vec3& x)
{
    const Vec3 y = rotated_back(p, x);
    return rotated(p, {s.x * y.x, s.y * y.y, s.z * y.z});
}

/// ω of a clump with w = L/J [rad/s]
HILDA_HD inline Vec3 clump_omega(const ClumpShape& s, const EulerParameters<double>& p, const Vec3& w)
{
    return s.is_isotropic() ? w : w + scaled_in_frame(p, s.extra, w);
}

/// w = L/J of a clump with the angular velocity ω [rad/s]
HILDA_HD inline Vec3 clump_momentum(const ClumpShape& s, const EulerParameters<double>& p, const Vec3& omega)
{
    if (s.is_isotropic()) return omega;
    return scaled_in_frame(p, {1 / (1 + s.extra.x), 1 / (1 + s.extra.y), 1 / (1 + s.extra.z)}, omega);
}

/// Largest rotation of a clump with different principal moments in one step [rad]
constexpr double most_clump_rotation = 1;

/// The rotation vector θ̄ of a step in the principal frame, from h w in this frame:
///
///     J_r(θ̄)⁻¹ K θ̄ = h w,    K = diag(J_k/J),    J_r(θ)⁻¹ a = a + 1/2 θ × a + c θ × (θ × a)
///
/// c = (1 - θ/2 cot(θ/2))/θ², by its series. The result is NaN if the iteration does not converge, or for a
/// rotation above most_clump_rotation. There are no functions whose bits differ between CPU and GPU.
HILDA_HD inline Vec3 clump_rotation(const ClumpShape& s, const Vec3& hw)
{
    const auto over_K = [&](const Vec3& a) {
        return a + Vec3{s.extra.x * a.x, s.extra.y * a.y, s.extra.z * a.z};
    };
    const Vec3 K{1 / (1 + s.extra.x), 1 / (1 + s.extra.y), 1 / (1 + s.extra.z)};
    Vec3 theta = over_K(hw);
    for (int k = 0; k < 100; ++k) {
        const double x2 = 0.25 * theta.dot(theta);
        const double c =
            (1. / 12) *
            (1 + x2 * (1. / 15 +
                       x2 * (2. / 315 + x2 * (1. / 1575 + x2 * (2. / 31185 + x2 * 1382. / 212837625)))));
        const Vec3 L{K.x * theta.x, K.y * theta.y, K.z * theta.z}, t = theta.cross(L);
        const Vec3 d = over_K(hw - (L + 0.5 * t + c * theta.cross(t)));
        theta += d;
        const double size = theta.norm();
        if (!(size <= most_clump_rotation)) break;
        if (d.norm() <= 4e-16 * size) return theta;
    }
    const double nan = 0 / (hw.x - hw.x);
    return {nan, nan, nan};
}

/// Coordinate along an axis from the low side of the domain [units]
HILDA_HD inline std::int64_t coordinate(const CellGrid& g, const Position& p, int axis)
{
    const std::int32_t cell = axis == 0   ? g.x_of(p.cell)
                              : axis == 1 ? g.y_of(p.cell)
                                          : g.z_of(p.cell),
                       at = axis == 0   ? p.x
                            : axis == 1 ? p.y
                                        : p.z;
    return std::int64_t{cell} * g.width[axis] + g.local(at, cell, axis);
}

/// Assigns the centre of mass to its cell at a neighbour search. Returns the number of the clump + 1 if it is
/// outside the domain, otherwise 0.
struct AssignClumpCell {
    detail::AssignCell assign;  ///< its arrays are not used
    ClumpBody* body;

    HILDA_HD float operator()(std::uint32_t c) const
    {
        const CellGrid& g = assign.grid;
        Position p = body[c].position;
        std::int32_t x = g.x_of(p.cell), y = g.y_of(p.cell), z = g.z_of(p.cell);
        const bool in_x = assign.move(x, p.x, 0), in_y = assign.move(y, p.y, 1),
                   in_z = assign.move(z, p.z, 2);
        if (!(in_x && in_y && in_z)) return static_cast<float>(c + 1);
        p.cell = g.pack(x, y, z);
        body[c].position = p;
        return 0;
    }
};

/// Lists the indices of the particles by id.
struct ListIds {
    const std::uint32_t* id;
    std::uint32_t* index;
    HILDA_HD void operator()(std::uint32_t k) const { index[id[k]] = k; }
};

/// exp(angle/2) ⊗ p, with one Newton step of the normalisation p·p = 1; see rotation_increment(). Below
/// 0.5 rad its series are short, with truncation errors below the rounding error.
HILDA_HD inline EulerParameters<double> clump_turned(const Vec3& angle, const EulerParameters<double>& p)
{
    const double q = 0.25 * angle.dot(angle);  // the square of half the angle
    if (!(q < 1. / 16)) {
        const EulerParameters<double> d = rotation_increment(angle, p);
        return {p.e0 + d.e0, p.e + d.e};
    }
    const double length = 1 + 0.5 * (1 - (p.e0 * p.e0 + p.e.dot(p.e)));
    const double c =
        length *
        (1 - q * (1. / 2 - q * (1. / 24 - q * (1. / 720 - q * (1. / 40320 -
                                                               q * (1. / 3628800 - q * (1. / 479001600)))))));
    const Vec3 s =
        (0.5 * length *
         (1 - q * (1. / 6 - q * (1. / 120 - q * (1. / 5040 - q * (1. / 362880 - q * (1. / 39916800))))))) *
        angle;
    return {c * p.e0 - s.dot(p.e), c * p.e + p.e0 * s + s.cross(p.e)};
}

/// The arrays of the members
struct MemberView {
    CellGrid grid;
    const ClumpShape* shape;
    const ClumpSphere* sphere;
    const std::uint32_t* index;  ///< of a particle, by id
    Position* position;
    Float4 *velocity, *omega;
    Compensation* compensation;
    Float4 *orientation, *orientation_compensation;  ///< nullptr unless orientations are stored

    HILDA_HD Vec3 offset(const ClumpBody& b, const ClumpSphere& sphere_of_b) const
    {
        return rotated(b.p, b.scale * sphere_of_b.X);
    }

    /// Moves a coordinate to that of the body and d [units], and returns the remainder [units]. An offset of
    /// zero gives the integers of the body.
    HILDA_HD float approach(std::int32_t& at, std::int64_t from, std::int64_t body, float remainder, double d,
                            int axis) const
    {
        const double units = d + remainder, whole = rint(units);
        std::int64_t way = body + static_cast<std::int64_t>(whole) - from;
        if (grid.periodic[axis] != 0) {
            const std::int64_t length = std::int64_t{grid.width[axis]} * grid.cells[axis];
            while (2 * way > length) way -= length;
            while (2 * way < -length) way += length;
        }
        at = wrapped_sum(at, static_cast<std::int32_t>(way));
        return static_cast<float>(units - whole);
    }

    /// Sets positions and velocities of the members:  r_i = r + d_i,  v_i = v + ω × d_i,  ω_i = ω
    HILDA_HD void place(const ClumpBody& b) const
    {
        const ClumpShape s = shape[b.shape];
        const Vec3 v = with_error(b.velocity, b.compensation.v),
                   w = with_error(b.momentum, b.compensation.omega), turns = clump_omega(s, b.p, w);
        const Vec<float> rest = unpack_remainder<float>(b.compensation.displacement);
        const std::int64_t x = coordinate(grid, b.position, 0), y = coordinate(grid, b.position, 1),
                           z = coordinate(grid, b.position, 2);
        const double per_unit = s.reach > 0 ? 1 / grid.unit : 0;
        for (std::uint32_t m = 0; m < s.count; ++m) {
            const std::uint32_t k = index[b.first_id + m];
            const ClumpSphere& one = sphere[s.first + m];
            const bool centred = one.X.x == 0 && one.X.y == 0 && one.X.z == 0;
            const Vec3 d = centred ? Vec3{0, 0, 0} : offset(b, one), units = per_unit * d;
            Position p = position[k];
            const Vec<float> remainder{approach(p.x, coordinate(grid, p, 0), x, rest.x, units.x, 0),
                                       approach(p.y, coordinate(grid, p, 1), y, rest.y, units.y, 1),
                                       approach(p.z, coordinate(grid, p, 2), z, rest.z, units.z, 2)};
            const SplitDisplacement<float> split = split_displacement(remainder, 0);
            position[k] = {p.cell, wrapped_sum(p.x, split.x), wrapped_sum(p.y, split.y),
                           wrapped_sum(p.z, split.z)};
            Compensation c = {.displacement = split.remainder};
            const float radius = velocity[k].w;
            if (centred) {
                velocity[k] = {b.velocity.x, b.velocity.y, b.velocity.z, radius};
                for (int a = 0; a < 3; ++a) c.v[a] = b.compensation.v[a];
            } else {
                const Vec3 u = v + turns.cross(d);
                velocity[k] = {static_cast<float>(u.x), static_cast<float>(u.y), static_cast<float>(u.z),
                               radius};
            }
            if (s.is_isotropic()) {
                omega[k] = b.momentum;
                for (int a = 0; a < 3; ++a) c.omega[a] = b.compensation.omega[a];
            } else {
                omega[k] = {static_cast<float>(turns.x), static_cast<float>(turns.y),
                            static_cast<float>(turns.z), b.momentum.w};
            }
            // A clump that is one sphere has integrated its orientation as that of a particle.
            const bool is_particle = s.count == 1 && centred && s.is_isotropic() && radius == b.velocity.w;
            if (orientation != nullptr && !is_particle) orient(k, b.p, s.axes);
            compensation[k] = c;
        }
    }
    /// Sets the orientation of the frame of the template.
    HILDA_HD void orient(std::uint32_t k, const EulerParameters<double>& principal,
                         const EulerParameters<double>& axes) const
    {
        const Vec3 a = -axes.e;
        const EulerParameters<double> p{principal.e0 * axes.e0 - principal.e.dot(a),
                                        principal.e0 * a + axes.e0 * principal.e + principal.e.cross(a)};
        const auto set = [](float& value, float& error, double x) {
            value = static_cast<float>(x), error = static_cast<float>(x - value);
        };
        Float4 &e = orientation[k], &c = orientation_compensation[k];
        set(e.x, c.x, p.e0), set(e.y, c.y, p.e.x), set(e.z, c.z, p.e.y), set(e.w, c.w, p.e.z);
    }
};

/// Advances a clump by a step, or by a part of it, and places its members. Returns the square of an upper
/// bound of the speed of its members [m²/s²]; infinity if it turns too far in one step.
struct AdvanceClump {
    MemberView members;
    ClumpBody* body;
    const Load* total;  ///< force and torque of each particle about its centre [N, N m]
    StepParameters step;

    HILDA_HD float operator()(std::uint32_t c) const
    {
        ClumpBody b = body[c];
        const ClumpShape s = members.shape[b.shape];
        Vec<float> F{0, 0, 0}, T{0, 0, 0};
        if (step.part != Part::before_loads) {
            sum_loads(b, s, F, T);
            const Vec3 before = clump_omega(s, b.p, to_double(b.momentum));
            b.omega_before = {static_cast<float>(before.x), static_cast<float>(before.y),
                              static_cast<float>(before.z), 0};
        }
        ParticleState<float> m{.v = vec(b.velocity),
                               .omega = vec(b.momentum),
                               .v_compensation = load_bfloat16(b.compensation.v),
                               .omega_compensation = load_bfloat16(b.compensation.omega),
                               .remainder = unpack_remainder<float>(b.compensation.displacement),
                               .radius = b.velocity.w,
                               .inverse_mass = b.momentum.w};
        Vec<float> acc = vec(b.acc), alpha = vec(b.alpha);
        const Displacement<float> moved = advance_particle(step, m, F, T, acc, alpha);
        put(b.acc, acc), put(b.alpha, alpha);
        put(b.velocity, m.v), put(b.momentum, m.omega);
        const SplitDisplacement<float> units =
            split_displacement(moved.translation, step.displacement_dither);
        b.compensation.displacement = units.remainder;
        store_bfloat16(b.compensation.v, m.v_compensation, step.velocity_dither),
            store_bfloat16(b.compensation.omega, m.omega_compensation, step.velocity_dither);
        double rate = 0;  // of the rotation [rad/s]
        if (step.part == Part::whole || step.part == Part::before_loads) {
            Position& p = b.position;
            p.x = wrapped_sum(p.x, units.x), p.y = wrapped_sum(p.y, units.y), p.z = wrapped_sum(p.z, units.z);
            Vec3 angle{moved.rotation.x, moved.rotation.y, moved.rotation.z};  // h w of the step
            if (!s.is_isotropic()) angle = rotated(b.p, clump_rotation(s, rotated_back(b.p, angle)));
            const double square = angle.dot(angle);
            if (s.reach > 0) rate = sqrt(square) / step.h;
            if (!(square < 1e18)) return static_cast<float>(0 * to_double(b.momentum).norm() + HUGE_VAL);
            b.p = clump_turned(angle, b.p);
        }
        body[c] = b;
        members.place(b);
        if (s.reach == 0) return m.v.dot(m.v);
        const double now = clump_omega(s, b.p, to_double(b.momentum)).norm();
        const double speed = to_double(b.velocity).norm() + larger(rate, now) * b.scale * s.reach;
        return static_cast<float>(1.000001 * speed * speed);
    }

    HILDA_HD static Vec<float> vec(const Float4& f) { return {f.x, f.y, f.z}; }
    HILDA_HD static void put(Float4& to, const Vec<float>& v) { to.x = v.x, to.y = v.y, to.z = v.z; }

    /// Resultant of the loads of the members about the centre of mass, in double precision in their order
    HILDA_HD void sum_loads(const ClumpBody& b, const ClumpShape& s, Vec<float>& F, Vec<float>& T) const
    {
        Vec3 F_all{0, 0, 0}, T_all{0, 0, 0};
        for (std::uint32_t m = 0; m < s.count; ++m) {
            const Load& load = total[members.index[b.first_id + m]];
            const Vec3 F_m = to_double(load.F);
            Vec3 T_m = to_double(load.M);
            const ClumpSphere& one = members.sphere[s.first + m];
            if (s.reach > 0) T_m += members.offset(b, one).cross(F_m);
            F_all = m == 0 ? F_m : F_all + F_m, T_all = m == 0 ? T_m : T_all + T_m;
        }
        F = {static_cast<float>(F_all.x), static_cast<float>(F_all.y), static_cast<float>(F_all.z)};
        T = {static_cast<float>(T_all.x), static_cast<float>(T_all.y), static_cast<float>(T_all.z)};
    }
};

}  // namespace hilda::granular
