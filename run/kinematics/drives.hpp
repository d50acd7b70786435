// SPDX-License-Identifier: GPL-3.0-or-later
/// The loads and powers of the drivers of a mechanism.

#pragma once

#include "run/columns/state_columns.hpp"

#include <memory>

namespace hilda::run {

/// For each row that prescribes a function of time f, the columns NAME.value, .rate, .acceleration (f, ḟ,
/// f̈), NAME.load = -λ and NAME.power = -λ ḟ, the power of the driver on the bodies. The load is the force or
/// the torque of a driver of a length or an angle; of other functions it is conjugate to f. For a DP1 driver
/// f = cos(g) or sin(g) it is the torque on the angle g, which has no jump where the complement takes over.
class DriveColumns final : public ColumnGroup {
public:
    /// The model must have been started, and must outlive this object.
    explicit DriveColumns(const dae::Model& model);

    void values(const lie::State& x, double* out) override;

private:
    struct Drive {
        size_t row;      ///< in Model::all_rows()
        int multiplier;  ///< index of its λ
    };
    static std::vector<Drive> drives_of(const dae::Model& model);
    static std::vector<dae::Quantity> columns_of(const dae::Model& model, const std::vector<Drive>& drives);
    DriveColumns(const dae::Model& model, std::vector<Drive> drives);

    const dae::Model& model;
    const std::vector<Drive> drives;
};

}  // namespace hilda::run
