// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/bindings/cosim.hpp"

#include "io/program.hpp"
#include "run/cosim/run_cosim.hpp"

#include <pybind11/stl.h>

namespace hilda::python {

namespace py = pybind11;

void define_cosim(py::module_& m)
{
    m.def(
        "_cosim",
        [](const std::string& file, const std::string& output, const std::vector<std::string>& set,
           std::optional<double> end, std::optional<double> interval, bool contacts, bool reactions,
           double checkpoint, int threads, bool fix_initial, bool force, bool resume, bool allow_paths) {
            run::CosimOptions options{.file = file};
            run::RunOptions& o = options.run;
            o.output = output;
            o.set = set;
            o.end = end;
            o.interval = interval;
            o.checkpoint = checkpoint;
            o.threads = threads;
            o.fix_initial = fix_initial;
            o.force = force;
            o.resume = resume;
            o.allow_paths = allow_paths;
            o.quiet = true;
            o.command_line = "hilda.cosim";
            if (contacts) o.outputs["--contacts"] = "";
            if (reactions) o.outputs["--reactions"] = "";
            const py::gil_scoped_release release;
            io::Interrupt::forget();
            return run::run_cosim(options);
        },
        py::arg("file"), py::arg("output"), py::arg("set"), py::arg("end"), py::arg("interval"),
        py::arg("contacts"), py::arg("reactions"), py::arg("checkpoint"), py::arg("threads"),
        py::arg("fix_initial"), py::arg("force"), py::arg("resume"), py::arg("allow_paths"));
}

}  // namespace hilda::python
