// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/experiments/chapter4/friction/experiment.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::studies::friction {

namespace {

void add_frame(Snapshots& to, const contact::Scene& scene, const std::vector<contact::Motion>& bodies)
{
    std::vector<Snapshots::ContactData> contacts;
    for (size_t k = 0; k < scene.pair.size(); ++k) {
        const contact::Scene::Pair& p = scene.pair[k];
        if (p.contact_state.N > 0)
            contacts.push_back(Snapshots::contact_data(static_cast<int>(k), p.i, p.contact_state, p.wrench,
                                                       p.history.deflections));
    }
    to.add(scene.t, bodies, std::move(contacts));
}

}  // namespace

size_t Series::column_index(const std::string& column) const
{
    return static_cast<size_t>(std::find(columns.begin(), columns.end(), column) - columns.begin());
}

std::vector<double> Series::all(const std::string& column) const
{
    std::vector<double> values;
    const size_t k = column_index(column);
    for (size_t row = 0; row < rows(); ++row) values.push_back(at(row, k));
    return values;
}

double Series::first_time(const std::function<bool(size_t)>& condition, double from) const
{
    for (size_t row = 0; row < rows(); ++row)
        if (at(row, 0) >= from && condition(row)) return at(row, 0);
    return std::nan("");
}

Series sample(contact::Scene& scene, double h, double end, Frames* frames, std::vector<std::string> columns,
              const std::function<void(Series&, const std::vector<contact::Motion>&)>& row)
{
    Series series(std::move(columns));
    const long steps = std::lround(end / h);
    EvenSelection choice(frames != nullptr ? frames->count : 0, steps);
    if (frames != nullptr)
        for (const contact::Scene::Pair& p : scene.pair) {
            frames->snapshots.add_surface(p.i, p.contact.i);
            frames->snapshots.add_surface(p.j, p.contact.j);
        }
    series.values.reserve(static_cast<size_t>(steps + 1) * series.columns.size());
    std::vector<contact::Motion> before;
    for (long n = 0; n <= steps; ++n) {
        scene.t = static_cast<double>(n) * h;
        before = scene.body;
        const double t = scene.t;
        scene.step(h);
        scene.t = t;
        row(series, before);
        if (choice.is_selected(n)) add_frame(frames->snapshots, scene, before);
    }
    return series;
}

const Series* Results::find(const std::string& run) const
{
    for (size_t k = 0; k < runs.size(); ++k)
        if (runs[k].name == run) return series[k].rows() > 0 ? &series[k] : nullptr;
    return nullptr;
}

contact::FrictionParameters preset(const std::string& name, const contact::FrictionParameters& p)
{
    return name == "dissertation" ? p.as_in_dissertation() : p;
}

std::shared_ptr<const contact::FrictionModel> law(const contact::FrictionParameters& p,
                                                  const std::string& name)
{
    return contact::friction_law(name).make(p);
}

contact::Motion at(const lie::Vec3& r, const lie::Vec3& rdot)
{
    contact::Motion m;
    m.r = r;
    m.rdot = rdot;
    return m;
}

contact::Inertia solid_sphere(double m, double R) { return {m, 0.4 * m * R * R * lie::Mat3::Identity()}; }

}  // namespace hilda::studies::friction
