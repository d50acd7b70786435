// SPDX-License-Identifier: GPL-3.0-or-later
/// Error handling of GSL: by return codes. The default handler of GSL aborts the program.

#pragma once

#include <gsl/gsl_errno.h>

namespace hilda::reference {

/// Turns off the error handler of GSL. Call it before a GSL function that can fail, and check its return
/// code.
inline void disable_gsl_error_handler()
{
    static const auto before = gsl_set_error_handler_off();
    static_cast<void>(before);
}

}  // namespace hilda::reference
