// SPDX-License-Identifier: GPL-3.0-or-later
#include "granular/case/output_keys.hpp"

#include <algorithm>
#include <cmath>

namespace hilda::granular {

namespace {

constexpr std::array axes = {"x", "y", "z"};

bool is_file_name(const std::string& name)
{
    return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
               c == '-';
    });
}

void read_cells(ObjectReader& o, FieldGrid& grid)
{
    const std::vector<double> cells = o.numbers(
        "cells", 3,
        {"Number of cells along x, y and z. At most 1e7 cells. One cell along two axes gives a profile.",
         "[1, 1, 60]", R"("items": {"type": "integer", "minimum": 1, "maximum": 1e7})"});
    constexpr double most = 1e7;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!(cells[axis] >= 1 && cells[axis] <= most && cells[axis] == std::trunc(cells[axis])))
            o.fail("cells", axis, "cells must be integers from 1 to 1e7, got " + io::shortest(cells[axis]));
        grid.cells[axis] = static_cast<int>(cells[axis]);
    }
    if (const double all = cells[0] * cells[1] * cells[2]; !(all <= most))
        o.fail("cells", "a grid must have at most 1e7 cells, got " + io::shortest(all));
}

FieldGrid read_grid(ObjectReader& o, const WorldOptions& world)
{
    FieldGrid grid;
    o.note("low", "vector", {"Lower corner of the grid [m], in the global frame.", "[0, 0, 0]"});
    o.note("high", "vector",
           {"Upper corner of the grid [m], in the global frame. The grid must intersect the domain. Along a "
            "periodic axis it must be within the domain; along others it may extend beyond it.",
            "[0.03, 0.02, 0.06]"});
    const std::vector<double> low = o.numbers("low", 3), high = o.numbers("high", 3);
    const std::array<double, 3> from = {world.low.x, world.low.y, world.low.z},
                                to = {world.high.x, world.high.y, world.high.z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        grid.low[axis] = low[axis], grid.high[axis] = high[axis];
        if (!(low[axis] < high[axis]))
            o.fail(
                "high", axis,
                "high must be above low, " + io::shortest(low[axis]) + ", got " + io::shortest(high[axis]));
        const std::string domain = std::string("the domain along ") + axes[axis] + ", from " +
                                   io::shortest(from[axis]) + " to " + io::shortest(to[axis]);
        if (low[axis] >= to[axis])
            o.fail("low", axis, "the grid is outside of " + domain + ", got " + io::shortest(low[axis]));
        if (high[axis] <= from[axis])
            o.fail("high", axis, "the grid is outside of " + domain + ", got " + io::shortest(high[axis]));
        if (!world.periodic[axis]) continue;
        if (low[axis] < from[axis])
            o.fail(
                "low", axis,
                "the grid must be within " + domain + ", which is periodic, got " + io::shortest(low[axis]));
        if (high[axis] > to[axis])
            o.fail(
                "high", axis,
                "the grid must be within " + domain + ", which is periodic, got " + io::shortest(high[axis]));
        grid.period[axis] = to[axis] - from[axis];
    }
    read_cells(o, grid);
    const std::string values =
        o.one_of("values", {"averages", "points"},
                 {"Values of a cell: averages over its volume, whose sum over the cells times the volume is "
                  "exactly the integral, or those at the points at the centres of the cells.",
                  R"("points")"},
                 "averages");
    grid.values = values == "points" ? FieldGrid::Values::points : FieldGrid::Values::averages;
    const std::string edges =
        o.one_of("edges", {"open", "closed"},
                 {"Sides of the grid, those along periodic axes excepted: open, the part of a kernel outside "
                  "of the grid is not counted; closed, the part inside is scaled to the whole, so that the "
                  "integral of the density is the mass of the particles whose centres are inside.",
                  R"("closed")"},
                 "open");
    grid.closed = edges == "closed";
    if (grid.closed && values == "points")
        o.fail("edges", "edges must be open with the values \"points\", got \"closed\"");
    return grid;
}

Kernel read_kernel(ObjectReader& o, const FieldGrid& grid)
{
    const std::vector<std::string> names(Kernel::names.begin(), Kernel::names.end());
    const std::string name =
        o.one_of("kernel", names,
                 {"Kernel: gaussian, cut at three widths along each axis and normalised, or lucy, 1 - 6 q^2 "
                  "+ 8 q^3 - 3 q^4 with q the distance over the width.",
                  R"("lucy")"},
                 names[0]);
    Kernel kernel;
    kernel.type = static_cast<Kernel::Type>(std::find(names.begin(), names.end(), name) - names.begin());
    kernel.width =
        o.positive("width", {"Width of the kernel [m]: standard deviation of the Gaussian, radius of Lucy's "
                             "kernel. Below the radius (lucy: diameter) of the largest particle the fields "
                             "have the structure of single particles, with a notice.",
                             "0.001"});
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double length = grid.high[axis] - grid.low[axis];
        if (kernel.width < 1e-6 * length)
            o.fail("width", std::string("width must be at least 1e-6 of the length of the grid along ") +
                                axes[axis] + ", " + io::shortest(length) + ", got " +
                                io::shortest(kernel.width));
        if (grid.period[axis] > 0 && kernel.width > grid.period[axis])
            o.fail("width", std::string("width must be at most the length of the domain along ") +
                                axes[axis] + ", which is periodic, " + io::shortest(grid.period[axis]) +
                                ", got " + io::shortest(kernel.width));
    }
    return kernel;
}

/// A number of samples, or the number of steps in an interval if this is less
long most_samples(long samples, double interval, double h)
{
    const double steps = std::max(1., std::floor(interval / h * (1 + 1e-9)));
    return steps < static_cast<double>(samples) ? static_cast<long>(steps) : samples;
}

/// Number of samples of an interval [s] with steps of size h: at least 1 and at most one in each step
long read_samples(ObjectReader& o, const io::About& about, long fallback, double interval, double h)
{
    const long samples = o.count("samples", about, fallback);
    const long most = most_samples(samples, interval, h);
    if (samples < 1 || samples > most)
        o.fail("samples", "samples must be from 1 to the number of steps of the interval, " +
                              std::to_string(most) + ", got " + std::to_string(samples));
    return samples;
}

FieldSpec read_field(ObjectReader& o, const WorldOptions& world, const std::string& number)
{
    o.defines("field", "Field",
              "Fields of the particles of a replica on a regular grid: density, volume fraction, momentum, "
              "velocity, kinetic stress, contact stress and the force density of boundaries on particles. "
              "The files are fields-NAME.csv, fields-NAME.pvd and vtk/fields-NAME-*.vti.");
    FieldSpec spec;
    spec.name = o.name(
        "name",
        {.text =
             "Name in the file names: letters, digits, - and _. By default the number of the entry, from 0.",
         .example = R"("profile")",
         .rest = R"("pattern": "^[A-Za-z0-9_-]+$")",
         .computed = true},
        number);
    if (!is_file_name(spec.name))
        o.fail("name",
               "name must consist of letters, digits, - and _, because it is part of file names, got " +
                   io::described(spec.name));
    spec.grid = read_grid(o, world);
    spec.kernel = read_kernel(o, spec.grid);
    spec.interval = o.positive("interval", {"Time between outputs [s], rounded to whole steps.", "0.01"});
    spec.samples = read_samples(o,
                                {"Number of equally spaced instants of the interval before an output whose "
                                 "mean it has. With 1 it has the instant.",
                                 "20", R"("minimum": 1)"},
                                1, spec.interval, world.h);
    const long replica = o.count(
        "replica", {"Number of the replica whose particles the fields have.", "1", R"("maximum": 65535)"}, 0);
    if (replica > 0xffff) o.fail("replica", "replica must be at most 65535, got " + std::to_string(replica));
    spec.replica = static_cast<int>(replica);
    o.note("group", "name",
           {"Group whose particles the fields have. The other particles count as boundaries. By default all "
            "particles.",
            R"("bed")"});
    if (o.has("group")) spec.group = o.name("group");
    o.finish();
    return spec;
}

std::vector<FieldSpec> read_fields(ObjectReader& o, const WorldOptions& world)
{
    std::vector<FieldSpec> all;
    for (ObjectReader& one :
         o.objects("fields", "field",
                   {"Coarse-grained fields on regular grids: density, momentum, stresses and the force of "
                    "boundaries.",
                    R"([{"name": "profile", "low": [0, 0, 0], "high": [0.03, 0.02, 0.06], )"
                    R"("cells": [1, 1, 60], "width": 0.001, "interval": 0.01}])"})) {
        all.push_back(read_field(one, world, std::to_string(all.size())));
        for (std::size_t k = 0; k + 1 < all.size(); ++k)
            if (all[k].name == all.back().name)
                one.fail("name", "two fields have the same name, got " + io::described(all.back().name));
    }
    return all;
}

ContactSpec read_contacts(ObjectReader o)
{
    o.defines(
        "contact_output", "Contact output",
        "Lists of contacts in contact-lists.csv, at multiples of an interval and at single times, and lines "
        "between the particles in contact in the frames. At least one of the three must be given.",
        R"("anyOf": [{"required": ["interval"]}, )"
        R"({"properties": {"times": {"minItems": 1}}, "required": ["times"]}, )"
        R"({"properties": {"network": {"const": true}}, "required": ["network"]}])");
    ContactSpec spec;
    if (o.given("interval"))
        spec.interval = o.positive(
            "interval",
            {"Time between lists [s], rounded to whole steps. The first one is at t = 0.", "0.05"});
    o.note("times", R"("type": "array", "items": {"type": "number", "minimum": 0}, "default": [])",
           {"Times of further lists [s], rounded to whole steps.", "[0.12, 0.2]"});
    if (o.has("times")) {
        spec.times = o.numbers("times", o.list("times", true).size());
        for (std::size_t k = 0; k < spec.times.size(); ++k)
            if (!(spec.times[k] >= 0))
                o.fail("times", k, "times must not be negative, got " + io::shortest(spec.times[k]));
    }
    spec.network = o.flag(
        "network",
        {"Whether each frame has a part vtk/contacts-*.vtp: a line for each contact, with its normal force.",
         "true"},
        false);
    if (!spec.has_lists() && !spec.network)
        o.fail("contacts must have interval, times, or network with the value true, got none of them");
    o.finish();
    return spec;
}

LoadSpec read_loads(ObjectReader o, double h)
{
    o.defines("load_output", "Load output",
              "Mean and standard deviation of the force and the torque of the particles on each boundary, "
              "over equally spaced instants of an interval.");
    LoadSpec spec;
    spec.interval = o.positive("interval", {"Time of a mean [s], rounded to whole steps.", "0.01"});
    spec.samples = read_samples(
        o,
        {.text = "Number of equally spaced instants of an interval. A sample takes about the time of a step. "
                 "By default 100, or the number of steps of the interval if it has fewer.",
         .example = "50",
         .rest = R"("minimum": 1)",
         .computed = true},
        most_samples(100, spec.interval, h), spec.interval, h);
    o.finish();
    return spec;
}

}  // namespace

OutputSpecs read_outputs(ObjectReader& o, const WorldOptions& world)
{
    OutputSpecs all{.fields = read_fields(o, world)};
    if (o.has("contacts"))
        all.contacts = read_contacts(o.object("contacts",
                                              {"Lists of all contacts at chosen times, and the network of "
                                               "contacts in the frames for ParaView. By default none.",
                                               R"({"interval": 0.05, "network": true})"},
                                              "contact_output"));
    if (o.has("loads")) {
        all.loads = read_loads(o.object("loads",
                                        {"Mean and standard deviation over time of the loads on boundaries, "
                                         "in loads.csv. By default none.",
                                         R"({"interval": 0.01, "samples": 100})"},
                                        "load_output"),
                               world.h);
        if (o.find("boundaries") == nullptr || o.find("boundaries")->size() == 0)
            o.fail("loads", "loads needs boundaries, got none");
    }
    return all;
}

std::string width_notice(const FieldSpec& spec, double largest_diameter)
{
    const bool gaussian = spec.kernel.type == Kernel::Type::gaussian;
    const double least = gaussian ? largest_diameter / 2 : largest_diameter;
    if (spec.kernel.width >= least) return "";
    return "a width of " + io::shortest(spec.kernel.width) + " m is below the " +
           (gaussian ? "radius" : "diameter") + " of the largest particle, " + io::shortest(least) +
           " m: the fields have the structure of single particles";
}

}  // namespace hilda::granular
