// SPDX-License-Identifier: GPL-3.0-or-later
/// Heap of grains on a plate of finite width, and its angle of repose; see repose.cpp.

#pragma once

#include "granular/validations/bed_geometry.hpp"
#include "granular/validations/validation.hpp"

#include <functional>
#include <string>
#include <vector>

namespace hilda::granular {

/// A plate about x = 0, periodic along y, with a bed of grains between two walls at its edges. Width, length
/// and height are in mean diameters of the grains.
struct Heap {
    double mu = 0.5, mu_r = 0.05;  ///< coefficients of friction and of rolling resistance
    int seed = 1;                  ///< of the radii and of the places at the start
    double d = 4e-3;               ///< mean diameter of the grains [m]
    double E = 2e6;                ///< Young's modulus [Pa]
    double h = 1e-4;               ///< step [s]
    double width = 36;             ///< of the plate, along x
    double length = 8;             ///< period along y
    double height = 11;            ///< approximate height of the bed between the walls
    double speed = 0.2;            ///< at which the walls sink [m/s]

    double edge() const { return width * d / 2; }  ///< distance of an edge of the plate from the middle [m]
    double period() const { return length * d; }   ///< along y [m]
};

/// The surface of a heap as a function of x, averaged over y
struct HeapSurface {
    std::vector<double> x, z;  ///< [m]
};

/// The surface of the spheres: the height of the highest point of any sphere over a point (x, y), on a grid
/// of points at distances of about d/4, averaged over y. Points that no sphere covers have the height 0.
HeapSurface surface_of(const std::vector<BedSphere>& spheres, const Heap& heap);

/// Angles of the two flanks against the horizontal [°], positive if the heap falls to its edges: of the
/// straight line by least squares through the surface from 0.2 to 0.8 of the distance from the middle to the
/// edge
struct FlankAngles {
    double left = 0, right = 0;
    double r2 = 0;  ///< smaller coefficient of determination of the two lines

    double mean() const { return (left + right) / 2; }
};
FlankAngles flank_angles(const HeapSurface& surface, const Heap& heap);

/// A heap at rest
struct RestingHeap {
    std::vector<BedSphere> spheres;  ///< of the grains and of the plate
    double grains = 0;               ///< number of grains on the plate
    /// Mass on the plate plus mass that has left, over the initial mass, less 1
    double balance = 0;
};

/// The heap that remains when the walls have sunk to the plate. `progress` receives values from 0 to 1.
/// Throws io::NumericalFailure if the grains do not come to rest.
RestingHeap resting_heap(
    const Heap& heap, const ValidationOptions& options,
    const std::function<void(double)>& progress = [](double) {});

}  // namespace hilda::granular
