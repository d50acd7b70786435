// SPDX-License-Identifier: GPL-3.0-or-later
/// Formulas of a case in the grammar of the model files.

#pragma once

#include "granular/case/motion.hpp"

namespace hilda::granular {

/// Compiles a formula in t. Throws InvalidCase; a build without dae/expression.cpp rejects all formulas.
Formula compile(const std::string& text);

}  // namespace hilda::granular
