// SPDX-License-Identifier: GPL-3.0-or-later
/// Study granular-bucket: a two-link arm whose bucket digs in a bed of grains, in co-simulation.
///
/// The boom turns about a shoulder that is fixed, the second link with the bucket about the elbow, both
/// driven: the bucket sweeps through the bed, and the boom lifts it. At the end it is at rest above the bed,
/// and the force of the grains is the weight of those that it holds.

#include "io/archive.hpp"
#include "lie/so3.hpp"
#include "studies/experiments/chapter7/rigs/rig.hpp"
#include "studies/framework/columns.hpp"
#include "studies/framework/study_context.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace hilda::studies {

namespace {

using lie::Mat3;
using lie::Vec3;

constexpr double g = 9.81, rad = std::numbers::pi / 180;
constexpr double boom = 0.35, link = 0.22;                        ///< lengths [m]
constexpr double side = 0.09, width = 0.09, wall = 0.006;         ///< of the bucket [m]
constexpr double first_angle = -80 * rad, last_angle = 50 * rad;  ///< of the link against the vertical
constexpr double lift = 0.3;                                      ///< angle of the boom [rad]
constexpr double swept = 1.5, lifted = 2.1, end = 2.3;            ///< times [s]

struct BucketTest {
    std::string name;
    double depth = 0;  ///< of the sweep below the highest point of the bed [m]
    double mu = 0, mu_r = 0;
    long substeps = 0;
};

struct Grid {
    std::string name;
    std::vector<BucketTest> tests;
};

const std::vector<Grid> grids = {{"quick",
                                  {{"reference", 0.035, 0.6, 0.1, 4},
                                   {"twice the step", 0.035, 0.6, 0.1, 8},
                                   {"less friction", 0.035, 0.2, 0, 4}}},
                                 {"full",
                                  {{"reference", 0.035, 0.6, 0.1, 4},
                                   {"half the step", 0.035, 0.6, 0.1, 2},
                                   {"twice the step", 0.035, 0.6, 0.1, 8},
                                   {"less friction", 0.035, 0.2, 0, 4},
                                   {"shallow", 0.02, 0.6, 0.1, 4},
                                   {"deep", 0.043, 0.6, 0.1, 4}}}};

struct Result {
    BucketTest test;
    double held = 0;                      ///< mass of the grains in the bucket at the end [kg]
    double weight = 0;                    ///< mean vertical force of the grains then [N]
    double fill = 0;                      ///< volume of the grains at a packing of 0.6 over the capacity
    double work = 0, work_of_grains = 0;  ///< on the grains, of the bucket and by their energy balance [J]
    double largest_force = 0, energy_error = 0;    ///< [N], [J]
    std::vector<double> motion = {}, grains = {};  ///< rows of motion.csv and grains.csv
};

void transfer(io::Archive& a, Result& r)
{
    for (double* x :
         {&r.held, &r.weight, &r.fill, &r.work, &r.work_of_grains, &r.largest_force, &r.energy_error})
        a.value(*x);
    a.list(r.motion), a.list(r.grains);
}

io::Json as_json(const Vec3& a) { return {a[0], a[1], a[2]}; }

/// The arm at the start. The frames of the bodies are the global one.
struct Arm {
    Vec3 shoulder, elbow, bucket;  ///< inner corner of the bucket [m]
    Vec3 centre;                   ///< centre of mass of link and bucket [m]
    Mat3 A;  ///< rotation of the frame of the meshes, whose z axis is the width of the bucket

    Arm(const RigBed& bed, double top, double depth)
    {
        elbow = {bed.length / 2, bed.width / 2, top + link - depth};
        shoulder = elbow - Vec3(boom, 0, 0);
        const Vec3 d(std::sin(first_angle), 0, -std::cos(first_angle));
        bucket = elbow + link * d, centre = elbow + 0.7 * link * d;
        A = lie::exp(Vec3(0, -first_angle, 0)) * lie::exp(Vec3(std::numbers::pi / 2, 0, 0));
    }
};

io::Json model(const Arm& arm)
{
    const io::Json along_y = {0, 1, 0};
    const auto hinge = [&](const char* name, const char* i, const char* j, const Vec3& at_i,
                           const Vec3& at_j) -> io::Json {
        return {{"name", name},          {"type", "revolute"},         {"body_i", i},
                {"body_j", j},           {"s_bar_p_i", as_json(at_i)}, {"s_bar_q_j", as_json(at_j)},
                {"axis_bar_i", along_y}, {"axis_bar_j", along_y}};
    };
    const auto driver = [&](const char* name, const char* i, const char* j, double angle,
                            const std::string& shape) -> io::Json {
        return {{"name", name},
                {"type", "hinge-driver"},
                {"body_i", i},
                {"body_j", j},
                {"axis_bar_i", along_y},
                {"axis_bar_j", along_y},
                {"angle", fmt::format("{}*{}", angle, shape)}};
    };
    const Vec3 half(boom / 2, 0, 0);
    return {{"hilda_model", 1},
            {"name", "arm with a bucket"},
            {"gravity", {0, 0, -g}},
            {"end", end},
            {"bodies",
             {{{"name", "boom"},
               {"mass", 1},
               {"inertia", {0.002, 0.012, 0.012}},
               {"r", as_json(arm.elbow - half)}},
              {{"name", "bucket"},
               {"mass", 1.2},
               {"inertia", {0.008, 0.008, 0.004}},
               {"r", as_json(arm.centre)}}}},
            {"constraints",
             {hinge("shoulder", "ground", "boom", arm.shoulder, -half),
              hinge("elbow", "boom", "bucket", half, arm.elbow - arm.centre),
              driver("lift", "ground", "boom", -lift, smooth_step(swept, lifted)),
              driver("curl", "boom", "bucket", first_angle - last_angle, smooth_step(0, swept))}}};
}

/// The bucket: a bent plate and two side walls
io::Json boundaries(const Arm& arm)
{
    const auto mesh = [&](const char* name, double y, double length,
                          const std::vector<io::Json>& outline) -> io::Json {
        return {{"name", name},
                {"type", "mesh"},
                {"extrude", {{"outline", io::Json::List(outline)}, {"length", length}}},
                {"rotation", as_json(lie::log(arm.A))},
                {"r", as_json(arm.bucket + Vec3(0, y, 0))}};
    };
    const auto point = [](double x, double y) -> io::Json { return io::Json::List{x, y}; };
    const std::vector<io::Json> plate = {point(-wall, -wall), point(side, -wall), point(side, 0),
                                         point(0, 0),         point(0, side),     point(-wall, side)},
                                triangle = {point(-wall, -wall), point(side, -wall), point(-wall, side)};
    io::Json left = mesh("left wall", width / 2 + wall, wall, triangle),
             right = mesh("right wall", -width / 2, wall, triangle);
    left["part_of"] = right["part_of"] = "bucket";
    return {mesh("bucket", width / 2, width, plate), left, right};
}

Result measure(const BucketTest& test, const RigBed& bed, const RigRun& run, double top)
{
    Result r{.test = test};
    const double grain = 4. / 3 * std::numbers::pi * std::pow(bed.R, 3), above = top + 0.1;
    const auto held = std::count_if(run.z.begin(), run.z.end(), [&](double z) { return z > above; });
    r.held = 2500 * grain * static_cast<double>(held);
    r.fill = grain * static_cast<double>(held) / 0.6 / (0.5 * side * side * width);
    r.weight = -run.mean("bucket.Fz", lifted);
    r.energy_error = run.last("bucket.energy_error");
    r.work = -(run.last("bucket.work") - r.energy_error), r.work_of_grains = run.work_on_grains;
    const std::vector<double> t = run.tools.values("t"), x = run.tools.values("bucket.x"),
                              z = run.tools.values("bucket.z"), Fx = run.tools.values("bucket.Fx"),
                              Fz = run.tools.values("bucket.Fz"), work = run.tools.values("bucket.work");
    for (std::size_t k = 0; k < t.size(); ++k) {
        r.largest_force = std::max(r.largest_force, std::hypot(Fx[k], Fz[k]));
        if (k % 10 == 0) r.motion.insert(r.motion.end(), {t[k], x[k], z[k], Fx[k], Fz[k], -work[k]});
    }
    for (std::size_t k = 0; k < run.x.size(); ++k)
        r.grains.insert(r.grains.end(), {run.x[k], run.y[k], run.z[k]});
    return r;
}

const Columns<Result> columns{
    {{"test", "test", "{}", [](const Result& r) { return r.test.name; }},
     {"depth", "depth [m]", "{:.3f}", [](const Result& r) { return r.test.depth; }},
     {"mu", "mu", "{:.2g}", [](const Result& r) { return r.test.mu; }},
     {"substeps", "substeps", "{}", [](const Result& r) { return r.test.substeps; }},
     {"held", "held [kg]", "{:.4f}", &Result::held},
     {"weight", "weight [N]", "{:.4f}", &Result::weight},
     {"fill", "fill", "{:.2f}", &Result::fill},
     {"work", "work [J]", "{:.4f}", &Result::work},
     {"work_of_grains", &Result::work_of_grains},
     {"largest_force", "force [N]", "{:.1f}", &Result::largest_force},
     {"energy_error", "error [J]", "{:.1e}", &Result::energy_error}}};

std::vector<Criterion> criteria(const std::vector<Result>& results)
{
    constexpr double infinite = std::numeric_limits<double>::infinity();
    const auto of = [&](const char* name) {
        return *std::find_if(results.begin(), results.end(),
                             [&](const Result& r) { return r.test.name == name; });
    };
    const Result reference = of("reference"), coarse = of("twice the step"), slippery = of("less friction");
    double weight = 0, work = 0, mismatch = 0;
    for (const Result& r : results) {
        weight = std::max(weight, std::abs(r.weight / (r.held * g) - 1));
        work = std::max(work, std::abs(r.work / r.work_of_grains - 1));
        mismatch = std::max(mismatch, std::abs(r.energy_error / r.work));
    }
    return {
        between("largest difference of the force at rest and the weight of the grains held, relative", weight,
                0, 0.02),
        between("largest difference of the work of the bucket and the energy balance of the grains, relative",
                work, 0, 0.01),
        between("largest energy error over the work", mismatch, 0, 0.02),
        between("grains held over the capacity of the bucket", reference.fill, 0.5, 2),
        between("mass held with twice the step over the reference", coarse.held / reference.held, 0.9, 1.1),
        between("work with twice the step over the reference", coarse.work / reference.work, 0.9, 1.1),
        between("work with less friction over the reference", slippery.work / reference.work, 0, 1),
        between("energy error with twice the step over the reference",
                std::abs(coarse.energy_error / reference.energy_error), 1, infinite)};
}

void run_study(StudyContext& s)
{
    const Grid& grid = one_of_list("--grid", s.grid, grids);
    s.json["grid"] = grid.name;
    const RigBed soil{
        .length = 0.5, .width = 0.2, .depth = 0.1, .R = 7e-3, .k = 1e6, .h = 5e-5, .periodic = true};
    Rigs rigs(s);
    double top = 0;
    s.job([&] { top = rigs.settle(soil); }, [&](io::Archive& a) { a.value(top); });
    std::vector<Result> results;
    for (const BucketTest& test : grid.tests) results.push_back({.test = test});
    const auto job = [&](long k) {
        Result& result = results[static_cast<std::size_t>(k)];
        const BucketTest test = result.test;
        RigBed bed = soil;
        bed.mu = test.mu, bed.mu_r = test.mu_r;
        const Arm arm(bed, top, test.depth);
        const Vec3 r = arm.bucket + Vec3(0, width / 2, 0) - arm.centre;
        result = measure(test, bed,
                         rigs.run(test.name, bed, model(arm), boundaries(arm),
                                  {{"body", "bucket"}, {"r", as_json(r)}}, test.substeps, end),
                         top);
    };
    s.jobs(static_cast<long>(results.size()), job,
           [&](io::Archive& a, long k) { transfer(a, results[static_cast<std::size_t>(k)]); });
    Table motion({{"test"}, {"t"}, {"x"}, {"z"}, {"Fx"}, {"Fz"}, {"work"}}),
        grains({{"test"}, {"x"}, {"y"}, {"z"}});
    for (const Result& r : results)
        add_rows(motion, {r.test.name}, r.motion, 6), add_rows(grains, {r.test.name}, r.grains, 3);
    s.files = {{"motion.csv", motion.csv()}, {"grains.csv", grains.csv()}};
    s.table = columns.csv(results);
    s.text << "A bucket of " << side << " m digs in a bed of grains\n\n";
    columns.print(s.text, results);
    s.evaluate(criteria(results));
    s.figures = {s.name + ".png"};
}

const bool registered_granular_bucket = io::Registry<Study>::add(
    {.name = "granular-bucket",
     .answers = "two-link arm whose bucket digs in a bed of grains, in co-simulation",
     .options = {"--check", "--grid", "--shard"},
     .files = {"motion.csv", "grains.csv", "granular-bucket.png"},
     .run = run_study});

}  // namespace

}  // namespace hilda::studies
