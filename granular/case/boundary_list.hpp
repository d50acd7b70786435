// SPDX-License-Identifier: GPL-3.0-or-later
/// The entries of `boundaries` of a case: their names, bodies of several parts, and motions.

#pragma once

#include "granular/case/boundary_keys.hpp"
#include "granular/case/case_file.hpp"
#include "granular/case/entry_keys.hpp"
#include "granular/case/surface_notices.hpp"

namespace hilda::granular {

/// Each function throws io::InvalidInput.
class BoundaryList {
public:
    explicit BoundaryList(Case& out) : out(out) {}

    /// Reads the boundaries of an entry.
    void read(ObjectReader& o, const EntryKeys& keys);
    /// Adds all boundaries to the world of the case. Sets EntryKeys::free.
    void add(EntryKeys& keys);
    /// Evaluates the formulas of the boundaries for the first step, and registers them for all steps.
    void start_motions() const;

    /// Notices that depend on the largest diameter of the particles
    void check_sizes(double diameter)
    {
        surfaces.check_sizes(*out.world, diameter, out.notices);
        surfaces.check_periodic_sides(*out.world, diameter, out.notices);
    }
    /// Notices that depend on the places of the particles, which have been added
    void check_sides() { surfaces.check_sides(*out.world, out.notices); }
    /// Notices about tools that will fall
    void check_tools(const Vec3& gravity);

private:
    const NamedBoundary* find(const std::string& name) const;
    void sum_parts();
    void add(NamedBoundary& n, ObjectReader& o, EntryKeys& keys);
    void set_parts() const;

    Case& out;
    std::vector<std::pair<NamedBoundary, ObjectReader>> bounds;  ///< with their entries
    std::vector<std::pair<BoundaryMotion, ObjectReader>> motions;
    SurfaceNotices surfaces;
    std::size_t entry = 0;  ///< of the entry that is read
};

}  // namespace hilda::granular
