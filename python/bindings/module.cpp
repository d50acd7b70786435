// SPDX-License-Identifier: GPL-3.0-or-later
/// The extension module hilda._hilda. The package hilda has its public names.

#include "hilda/version.hpp"
#include "python/bindings/cosim.hpp"
#include "python/bindings/errors.hpp"
#include "python/bindings/fit.hpp"
#include "python/bindings/model.hpp"
#include "python/bindings/run.hpp"
#include "python/bindings/simulation.hpp"
#include "python/bindings/state.hpp"
#include "python/bindings/system.hpp"

PYBIND11_MODULE(_hilda, m)
{
    using namespace hilda::python;
    m.attr("__version__") = hilda::version::number;
    translate_exceptions("hilda.errors");
    define_state(m);
    define_model(m);
    define_system(m);
    define_run(m);
    define_simulation(m);
    define_fit(m);
    define_cosim(m);
}
