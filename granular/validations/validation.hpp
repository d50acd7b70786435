// SPDX-License-Identifier: GPL-3.0-or-later
/// Validations: small experiments whose answer is known, in closed form, from another code or from measurements.
///
/// What they compute is here, so that it can be run beside a GPU with nothing else there; the study of the same name adds
/// files, figures and the record of where a result comes from.

#pragma once

#include "granular/world/world.hpp"

#include <functional>
#include <string>
#include <variant>
#include <vector>

namespace hilda::granular {

struct ValidationOptions {
    bool full = false;   ///< every value of the dissertation; else those that say most, in less time
    Device device = {};  ///< of every World
    std::function<void(double)> progress = [](double) {};  ///< told the share that is done
};

/// Rows under named columns. The first of a result is what study.csv has; the others are curves.
struct ValidationTable {
    using Cell = std::variant<std::string, double>;

    std::string name;  ///< of the file, without .csv
    std::vector<std::string> columns;
    std::vector<std::vector<Cell>> rows;
};

/// What came out, and between which bounds it must be; NaN is between none.
struct ValidationCheck {
    std::string what;
    double measured = 0, least = 0, most = 0;

    bool met() const { return measured >= least && measured <= most; }
};

/// The larger one; what is not a number is larger than all numbers, so that it is not lost where a worst is collected.
inline double worse(double a, double b) { return a != a || b <= a ? a : b; }

struct ValidationResult {
    std::vector<ValidationTable> tables;
    std::vector<ValidationCheck> checks;
};

struct Validation {
    std::string name;     ///< head-on, ...
    std::string answers;  ///< the figure it answers, one line
    ValidationResult (*run)(const ValidationOptions&) = nullptr;
};

const std::vector<Validation>& validations();
bool register_validation(Validation validation);

}  // namespace hilda::granular
