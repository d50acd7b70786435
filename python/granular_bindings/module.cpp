// SPDX-License-Identifier: GPL-3.0-or-later
/// The extension module hilda_granular._granular. The package hilda_granular has its public names.

#include "granular/case/built_in_cases.hpp"
#include "granular/stages/stages.hpp"
#include "hilda/version.hpp"
#include "io/error.hpp"
#include "io/files.hpp"
#include "io/nearest.hpp"
#include "python/bindings/errors.hpp"
#include "python/granular_bindings/arrays.hpp"
#include "python/granular_bindings/boundaries.hpp"
#include "python/granular_bindings/particles.hpp"
#include "python/granular_bindings/steps.hpp"

#include <pybind11/stl.h>

#include <filesystem>

namespace hilda::python {

namespace {

/// Text of a case file or of a built-in case, and whether it is a file, which has precedence
std::pair<std::string, bool> text_of(const std::string& name)
{
    std::error_code error;
    const bool is_file = std::filesystem::exists(name, error);
    const granular::BuiltInCase* const found = is_file ? nullptr : granular::find_built_in_case(name);
    if (found != nullptr) return {found->text, false};
    try {
        return {io::read_file(name, io::JsonSource::max_bytes), true};
    } catch (const io::IoError& e) {
        std::vector<std::string> known;
        for (const granular::BuiltInCase& c : granular::built_in_cases()) known.push_back(c.name);
        throw io::InvalidInput(e.what() + (is_file ? "" : io::did_you_mean(name, known)));
    }
}

std::vector<std::string> names_of_materials(WorldObject& o)
{
    std::vector<std::string> names;
    const io::Json& all = o.of().source.root.member("materials")->value;
    for (std::size_t k = 0; k < all.size(); ++k) names.push_back(*all.at(k).member("name")->value.string());
    return names;
}

void set_gravity(WorldObject& o, const Numbers& given)
{
    const Use use(o, "World.gravity");
    o.world().set_gravity(vector_at(given.data(), 0));
    o.world().start_balance();
}

/// A property that needs no state of the particles
template <class F>
auto query(const F& f)
{
    return [f](WorldObject& o) {
        const Use use(o, "World", Use::queries);
        return f(o);
    };
}

void define_world(py::module_& m)
{
    py::class_<WorldObject, WorldPointer> world(m, "_World");
    world
        .def(py::init([](const std::string& text, const std::string& file, std::vector<std::string> set,
                         std::string folder, std::string base, std::optional<std::uint64_t> seed, int threads,
                         std::string device, bool force, bool watch) {
            const WorldSettings settings{std::move(set), std::move(folder), std::move(base), seed,
                                         threads,        std::move(device), force,           watch};
            const py::gil_scoped_release release;
            return std::make_shared<WorldObject>(text, file, settings);
        }))
        .def("advance", &advance)
        .def("end_run",
             [](WorldObject& o) {
                 const Use use(o, "World.run");
                 o.end_run();
             })
        .def_property_readonly("name", query([](WorldObject& o) { return o.of().name; }))
        .def_property_readonly("t", query([](WorldObject& o) { return o.world().t(); }))
        .def_property_readonly("steps", query([](WorldObject& o) { return o.world().steps(); }))
        .def_property_readonly("h", query([](WorldObject& o) { return o.of().h; }))
        .def_property_readonly("end", query([](WorldObject& o) { return o.of().end; }))
        .def_property_readonly("interval", query([](WorldObject& o) { return o.of().interval; }))
        .def_property_readonly("count", query([](WorldObject& o) { return o.world().count(); }))
        .def_property_readonly("boundaries", query([](WorldObject& o) { return o.of().boundaries; }))
        .def_property_readonly("materials", query(&names_of_materials))
        .def_property_readonly("groups", query([](WorldObject& o) {
                                   return o.of().groups != nullptr ? o.of().groups->names
                                                                   : std::vector<std::string>{};
                               }))
        .def_property_readonly("stage", query([](WorldObject& o) -> py::object {
                                   if (o.of().stages == nullptr) return py::none();
                                   return py::str(o.of().stages->what().name);
                               }))
        .def_property_readonly("warnings", query([](WorldObject& o) { return o.warnings; }))
        .def_property_readonly("text", query([](WorldObject& o) { return o.of().source.current_text(); }))
        .def_property_readonly("has_orientation",
                               query([](WorldObject& o) { return o.world().has_orientation(); }))
        .def_property("gravity", query([](WorldObject& o) { return array_of(o.world().gravity()); }),
                      &set_gravity);
    define_particles(world);
    define_boundaries(world);
}

}  // namespace

}  // namespace hilda::python

PYBIND11_MODULE(_granular, m)
{
    using namespace hilda;
    m.attr("__version__") = version::number;
    python::translate_exceptions("hilda_granular.errors");
    pybind11::register_local_exception_translator([](std::exception_ptr thrown) {
        try {
            if (thrown != nullptr) std::rethrow_exception(std::move(thrown));
        } catch (const granular::DeviceError& error) {
            const pybind11::object raised = python::error_class("NotAvailable")(error.what());
            PyErr_SetObject(pybind11::type::of(raised).ptr(), raised.ptr());
        }
    });
    python::define_world(m);
    m.def("_text_of", &python::text_of);
    m.def("_cases", [] {
        std::vector<std::pair<std::string, std::string>> all;
        for (const granular::BuiltInCase& c : granular::built_in_cases()) all.emplace_back(c.name, c.note);
        return all;
    });
}
