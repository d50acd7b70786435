// SPDX-License-Identifier: GPL-3.0-or-later
/// Snapshots of bodies in contact, for ParaView.

#pragma once

#include "contact/compliant/contact.hpp"
#include "studies/running/tessellation.hpp"

#include <string>
#include <vector>

namespace hilda::studies {

/// `count` of the nodes 0 … steps, in turn: the first, the last and evenly between
class EvenChoice {
public:
    EvenChoice(int count, long steps) : count(count), steps(steps) {}

    bool takes(long n);

private:
    long next() const;

    int count;
    long steps;
    int selected = 0;
};

/// What there is to see of a run: the surfaces of its bodies, and instants. They are kept until the run has ended,
/// for only then it is known how much of a plane must be drawn.
///
/// A frame is VTK's XML PolyData, in ASCII: polygons, and a vertex at each contact that presses. Its cells say which
/// `body` they belong to and which `contact` they are, -1 for polygons. Its points have their `velocity` [m/s]; those
/// of contacts `normal_force` and `friction` [N], both on the first body, and whether they are `slipping`, `rolling`.
class Snapshots {
public:
    /// A surface on a body, -1 for one that stands at the origin. What is shown already is not shown twice.
    void show(int body, const contact::Shape& shape);

    /// A contact at an instant
    struct ContactPoint {
        int contact, i;  ///< its number, and that of its first body
        lie::Vec3 C, N, F;
        bool slipping, rolling;
    };
    static ContactPoint contact_point(int contact, int i, const contact::ContactState& now,
                                      const contact::Wrench& friction, const contact::Deflections& history);

    void add(double t, std::vector<lie::Motion> bodies, std::vector<ContactPoint> touches);

    /// DIR/vtk/NAME-000000.vtp and so on, then DIR/NAME.pvd, which lists them with their times
    void write(const std::string& directory, const std::string& name) const;
    /// What an earlier write() of that name left
    static void remove(const std::string& directory, const std::string& name);

    static constexpr int most = 1000000;  ///< frames that have different names

private:
    struct Shown {
        int body;
        contact::Shape shape;
    };
    struct Instant {
        double t;
        std::vector<lie::Motion> body;
        std::vector<ContactPoint> contact_point;
    };
    /// A mesh in the frame of its body
    struct Piece {
        int body;
        Mesh mesh;

        bool operator==(const Piece&) const = default;
    };

    std::vector<Piece> pieces() const;
    Reach reach(const Shown& of, const std::vector<double>& radius) const;
    static std::string poly_data(const Instant& now, const std::vector<Piece>& pieces);

    std::vector<Shown> shown;
    std::vector<Instant> instants;
};

}  // namespace hilda::studies
