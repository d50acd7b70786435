// SPDX-License-Identifier: GPL-3.0-or-later
/// Emptying of a silo, case 1 of the comparison of codes for bulk processes; see silo.cpp.

#pragma once

#include "granular/validations/comparison/bulk_materials.hpp"
#include "granular/validations/validation.hpp"

namespace hilda::granular {

struct Silo {
    double orifice = 0.06;       ///< diameter [m]
    BulkMaterial material = M1;  ///< of the grains
    long grains = 100000;        ///< published number
    BulkScale scale = {};
    double time = 5;       ///< of the discharge [s]
    double sample = 0.02;  ///< interval of the samples [s]

    double radius() const { return 2e-3 * scale.size; }  ///< of a grain [m]
    long number() const { return scale.number(grains); }
    double h() const { return bulk_step(radius(), material, scale); }
    /// Depth of the orifice below the lower edge of the cylinder [m]
    double depth() const;
};

/// Grains above the orifice over time
struct SiloFlow {
    std::vector<double> t, retained;
    double balance = 0;  ///< number of grains in the domain and removed, less the initial one

    /// Grains per second: slope of the line by least squares through the samples from 0.3 s on with at least
    /// 0.35 of the grains above the orifice
    double rate() const;
    /// The same of the second half of these samples over that of the first half
    double steady() const;

private:
    double slope(double from, double to) const;
};

/// The flow after the grains have settled on the closed orifice. `progress` receives values from 0 to 1.
/// Throws io::NumericalFailure if they do not settle.
SiloFlow silo_flow(
    const Silo& silo, const ValidationOptions& options,
    const std::function<void(double)>& progress = [](double) {});

}  // namespace hilda::granular
