// SPDX-License-Identifier: GPL-3.0-or-later
/// Clipping of a face of a polytope by the sides of a face of another one.  Sutherland, Hodgman (1974)

#pragma once

#include "contact/detection/separating_axis.hpp"

#include <cstdint>

namespace hilda::contact {

/// The parts of two bodies that make a contact point: a vertex of one of them, or an edge of each. Numbers of
/// edges have the bit of_edge.
struct TouchingParts {
    static constexpr std::uint32_t any = 0xffff, of_edge = 0x4000;

    std::uint32_t a = any, b = any;

    static TouchingParts edges(int a, int b)
    {
        return {of_edge | static_cast<std::uint32_t>(a), of_edge | static_cast<std::uint32_t>(b)};
    }
    TouchingParts exchanged() const { return {b, a}; }
};

/// Corners that are merged, see Manifold::mean_places
class MergedPoint {
public:
    void add(double share, double overlap, const Vec3& x)
    {
        first += share * overlap, second += share * overlap * overlap, moment += share * overlap * x;
    }
    double share() const { return second > 0 ? first * first / second : 0; }
    Vec3 place(const Vec3& otherwise) const { return first > 0 ? Vec3(moment / first) : otherwise; }

private:
    double first = 0, second = 0;
    Vec3 moment = Vec3::Zero();
};

/// Corners that may be contact points, in the frame of a face or plane
class ContactCorners {
public:
    struct Corner {
        Vec3 x;           ///< in the frame of both PlacedCores
        int side;         ///< the side that begins here: an edge of the incident body, or first_side + number
        int vertex;       ///< of the incident body, -1 if it is none
        int side_before;  ///< the side that ends here
        double share;     ///< see area_shares(), of the clipped polygon
    };
    std::vector<Corner> corner;

    /// Removes the corners with height n · (x - p) >= reach over the point p. Of more than `most` the lowest
    /// one remains and those that are farthest in most - 1 directions.
    void keep(const Vec3& n, const Vec3& p, double reach, int most);
    /// Of more than `most` corners removes those with height >= overlaps_below, and merges them if there are
    /// still more, see Manifold::mean_places. Returns whether it has merged corners.
    bool merge(const Vec3& n, const Vec3& p, double overlaps_below, int most);

protected:
    std::vector<Corner> other;

private:
    template <class Measure>
    void take_largest(const Measure& measure);
    void take_farthest(const Vec3& n, int most);
};

/// The part of a face, edge or vertex of a body within the prism of a face of another body
class ClippedFace : public ContactCorners {
public:
    /// Clips the face of `incident` that is most opposite to the face f of `reference`; all vertices of a
    /// body without faces. n is the normal of f. Corners within `length` [m] of a side count as inside.
    void set(const PlacedCore& reference, int f, const Vec3& n, const PlacedCore& incident, double length);
    /// The parts of a corner; a is the reference body
    TouchingParts parts(const Corner& c, const Polytope::Face& reference) const;

private:
    static constexpr int first_side = 1 << 16;

    void clip(const Vec3& outward, double limit, int side, double length);

    std::vector<Vec3> outline;
    std::vector<double> share;
};

}  // namespace hilda::contact
