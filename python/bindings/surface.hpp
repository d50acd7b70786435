// SPDX-License-Identifier: GPL-3.0-or-later
/// Surfaces that are objects in Python.

#pragma once

#include "contact/surface.hpp"
#include "python/bindings/model_function.hpp"

#include <memory>
#include <vector>

namespace hilda::python {

/// An object of a class derived from hilda.Surface: value(a), gradient(a), hessian(a) and, for a convex
/// surface, support(u). Without hessian it is a central difference of the gradient, with an error of about
/// 1e-10.
class PythonSurface final : public contact::Surface, public ModelFunctions {
public:
    explicit PythonSurface(const py::object& object);

    std::string name() const override { return label; }
    double value(const lie::Vec3& a) const override;
    lie::Vec3 gradient(const lie::Vec3& a) const override;
    lie::Mat3 hessian(const lie::Vec3& a) const override;
    double sigma() const override { return is_concave ? -1 : 1; }
    bool convex() const override { return has_support; }
    std::optional<lie::Vec3> support(const lie::Vec3& u) const override;
    double size() const override { return length; }

private:
    enum Which { value_, gradient_, hessian_, support_ };
    py::object call(Which which, const lie::Vec3& a) const;
    std::string place(const char* what, const lie::Vec3& a) const;

    std::string label;
    double length = 0;
    bool is_concave = false, has_hessian = false, has_support = false;
};

/// While it exists, models that this thread reads may have surfaces {"type": "python", "number": k} with the
/// objects of this list.
class SurfacesOfModel {
public:
    explicit SurfacesOfModel(const std::vector<py::object>& objects);
    ~SurfacesOfModel();
    SurfacesOfModel(const SurfacesOfModel&) = delete;
    SurfacesOfModel& operator=(const SurfacesOfModel&) = delete;

    std::vector<std::shared_ptr<PythonSurface>> made;  ///< of the models that were read

private:
    SurfacesOfModel* const before;
};

}  // namespace hilda::python
