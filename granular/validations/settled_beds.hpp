// SPDX-License-Identifier: GPL-3.0-or-later
/// Settled beds of grains that are kept in files, so that a second run of a validation does not settle them
/// again.

#pragma once

#include "io/archive.hpp"

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace hilda::granular {

/// What determines a settled bed: the name of the experiment and all parameters of the settling
struct BedCase {
    std::string name;
    std::vector<std::pair<std::string, double>> parameters;

    /// "cratering: R = 0.001, h = 5e-06"; numbers with 17 digits
    std::string description() const;
    /// 16 hexadecimal digits, a checksum of the description
    std::string hash() const;
};

/// Files FOLDER/HASH.bed with settled beds.
///
/// A file contains the description of its case, the version of the program and a checksum. If one of them is
/// not as expected, or the file cannot be read, the bed is computed again and the file replaced, with one
/// warning. A bed does not depend on the number of threads, and neither does its file.
struct SettledBeds {
    std::string folder;   ///< empty: no files
    std::string program;  ///< version of the program

    using Compute = std::function<void()>;
    using Transfer = std::function<void(io::Archive&)>;
    /// Reads the bed of a case from its file; computes it and writes the file if there is none. `transfer`
    /// writes or reads the bed, and throws io::IoError if its content is not valid. A file that cannot be
    /// written is a warning.
    void bed(const BedCase& of, const Compute& compute, const Transfer& transfer) const;
};

}  // namespace hilda::granular
