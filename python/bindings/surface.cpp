// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/bindings/surface.hpp"

#include "contact/surface_types.hpp"
#include "io/error.hpp"

#include <fmt/format.h>

namespace hilda::python {

namespace {

constexpr double difference = 6e-6;  // times the size of the surface

py::array_t<double> array_of(const lie::Vec3& v)
{
    return py::array_t<double>(3, v.data());  // a copy
}

struct Objects {
    const std::vector<py::object>* all = nullptr;
    SurfacesOfModel* of = nullptr;
};
thread_local Objects current;

std::shared_ptr<const contact::Surface> read_surface(dae::ObjectReader& o)
{
    const double number =
        o.number("number", {"Number of the object [-].", "0", R"("type": "integer", "minimum": 0)"});
    if (current.all == nullptr || !(number >= 0 && number < static_cast<double>(current.all->size())))
        o.fail("number", "there is no surface with this number; give the object to Model.contact()");
    auto surface = std::make_shared<PythonSurface>((*current.all)[static_cast<size_t>(number)]);
    current.of->made.push_back(surface);
    return surface;
}

const bool registered = io::Registry<contact::SurfaceType>::add(
    {.name = "python",
     .schema = {.description = "Object of a Python class derived from hilda.Surface.",
                .examples = {R"("number": 0)"}},
     .read = read_surface,
     .format_only = true});

}  // namespace

SurfacesOfModel::SurfacesOfModel(const std::vector<py::object>& objects) : before(current.of)
{
    if (before != nullptr) throw io::UsageError("a surface must not read a model while it is read");
    current = {&objects, this};
}

SurfacesOfModel::~SurfacesOfModel() { current = {}; }

PythonSurface::PythonSurface(const py::object& object)
    : ModelFunctions({}), label(py::str(py::type::of(object).attr("__name__")).cast<std::string>())
{
    has_hessian = py::hasattr(object, "hessian");
    has_support = py::hasattr(object, "support");
    call_python([&] { return "in the surface " + label; },
                [&] {
                    length = read_number(object.attr("size"), "size");
                    if (length < 0)
                        throw py::value_error(fmt::format("size must not be negative, got {}", length));
                    is_concave = object.attr("concave").cast<bool>();
                    for (const char* name : {"value", "gradient", "hessian", "support"})
                        functions.push_back(py::getattr(object, name, py::none()));
                });
}

std::string PythonSurface::place(const char* what, const lie::Vec3& a) const
{
    return fmt::format("{} of the surface {} at [{}, {}, {}]", what, label, a.x(), a.y(), a.z());
}

py::object PythonSurface::call(Which which, const lie::Vec3& a) const
{
    return functions[which](array_of(a));
}

double PythonSurface::value(const lie::Vec3& a) const
{
    return call_python([&] { return place("value", a); },
                       [&] { return read_number(call(value_, a), "value"); });
}

lie::Vec3 PythonSurface::gradient(const lie::Vec3& a) const
{
    return call_python([&] { return place("gradient", a); },
                       [&] {
                           lie::Vec3 all;
                           read_array(call(gradient_, a), "gradient", 3, 0, all.data());
                           return all;
                       });
}

lie::Mat3 PythonSurface::hessian(const lie::Vec3& a) const
{
    lie::Mat3 all;
    if (has_hessian) {
        call_python([&] { return place("hessian", a); },
                    [&] { read_array(call(hessian_, a), "hessian", 3, 3, all.data()); });  // symmetric
        return all;
    }
    const double h = difference * (length > 0 ? length : 1);
    for (int k = 0; k < 3; ++k)
        all.col(k) = (gradient(a + h * lie::Vec3::Unit(k)) - gradient(a - h * lie::Vec3::Unit(k))) / (2 * h);
    return 0.5 * (all + all.transpose());
}

std::optional<lie::Vec3> PythonSurface::support(const lie::Vec3& u) const
{
    if (!has_support) return {};
    return call_python([&] { return place("support", u); },
                       [&] {
                           lie::Vec3 all;
                           read_array(call(support_, u), "support", 3, 0, all.data());
                           return all;
                       });
}

}  // namespace hilda::python
