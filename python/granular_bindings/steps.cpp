// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/granular_bindings/steps.hpp"

#include "python/bindings/signals.hpp"

namespace hilda::python {

namespace {

bool is_ended_by(const py::object& before)
{
    const py::gil_scoped_acquire gil;
    const int truth = PyObject_IsTrue(before().ptr());
    if (truth < 0) throw py::error_already_set();
    return truth == 1;
}

}  // namespace

long advance(WorldObject& o, long n, const py::object& before)
{
    const Use use(o, "World.step", Use::steps);
    const bool calls = !before.is_none();
    Signals signals;
    long done = 0;
    {
        const py::gil_scoped_release release;
        while (done < n && !signals.raised()) {
            if (o.stages_are_over() || (calls && is_ended_by(before))) break;
            o.step();
            ++done;
        }
    }
    if (signals.error()) throw py::error_already_set(*signals.error());
    return done;
}

}  // namespace hilda::python
