// SPDX-License-Identifier: GPL-3.0-or-later
/// Formulas of a case, in the grammar of the model files.

#pragma once

#include "granular/case/motion.hpp"

namespace hilda::granular {

/// InvalidCase, also for all formulas where this program was built without dae/expression.cpp beside it.
Formula compile(const std::string& text);

}  // namespace hilda::granular
