// SPDX-License-Identifier: GPL-3.0-or-later
/// GSL reports errors to us instead of ending the program.

#pragma once

#include <gsl/gsl_errno.h>

namespace hilda::reference {

/// Call before anything of GSL that can fail; every return code is then ours to look at.
inline void silence_gsl()
{
    static const auto before = gsl_set_error_handler_off();
    static_cast<void>(before);
}

}  // namespace hilda::reference
