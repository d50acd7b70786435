// SPDX-License-Identifier: GPL-3.0-or-later
/// Reading of drivers, and the registered reader of contacts.
#include "dae/model_types.hpp"

#include "dae/curves/sampled_curve.hpp"
#include "dae/driver.hpp"
#include "io/arithmetic/jet.hpp"
#include "io/files.hpp"
#include "io/formats/csv.hpp"
#include "io/nearest.hpp"
#include "io/option_values.hpp"
#include "lie/check.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

namespace hilda::dae {

namespace {

struct Samples {
    std::vector<double> t, f;
};

/// The columns t and `column` of a CSV file
Samples read_samples(ObjectReader& o, const std::string& file, const std::string& column)
{
    constexpr std::size_t most = std::size_t{64} << 20;
    Samples all;
    try {
        io::read_csv(io::read_file(file, most), file, [&](const io::CsvRow& row) {
            for (const auto& [name, to] : {std::pair(std::string("t"), &all.t), {column, &all.f}}) {
                const auto at = std::find(row.names.begin(), row.names.end(), name);
                if (at == row.names.end())
                    o.fail("column", file + " has no column" +
                                         io::with_nearest(name, std::vector<std::string>(row.names.begin(),
                                                                                         row.names.end())));
                const std::string_view cell = row.cells[static_cast<std::size_t>(at - row.names.begin())];
                const std::optional<double> value = io::number_in<double>(cell);
                if (!value)
                    o.fail("file", row.place + ": " + name + " must be a number, got " +
                                       described(Json(std::string(cell))));
                to->push_back(*value);
            }
        });
    } catch (const io::IoError& e) {
        o.fail("file", e.what());
    } catch (const io::PlacedError&) {
        throw;
    } catch (const io::InvalidInput& e) {
        o.fail("file", e.what());
    }
    return all;
}

std::vector<double> list_of_numbers(ObjectReader& o, std::string_view key)
{
    return o.numbers(key, o.list(key, true).size());
}

/// A motion given by samples: {"file": ..., "column": ...} or {"t": [...], "f": [...]}. The canonical form
/// has the numbers.
Driver read_samples(ObjectReader& of, std::string_view key)
{
    ObjectReader o(of.object(key, {}, "motion"));
    Samples samples;
    o.exclude("file", "t"), o.exclude("file", "f");
    if (o.has("file")) {
        const std::string file = o.file("file");
        samples = read_samples(o, file, o.text("column"));
    } else {
        samples = {list_of_numbers(o, "t"), list_of_numbers(o, "f")};
    }
    o.finish();
    if (!samples.t.empty() && samples.t.front() > 0)
        of.fail(key, "the samples must begin at t = 0 s or before, got " + shortest(samples.t.front()));
    Json recorded = Json::object();
    recorded["t"] = Json::List(samples.t.begin(), samples.t.end());
    recorded["f"] = Json::List(samples.f.begin(), samples.f.end());
    of.record(key, std::move(recorded));
    try {
        return Driver(std::make_shared<SampledCurve>(samples.t, samples.f));
    } catch (const lie::InvalidInput& e) {
        of.fail(key, e.what());
    }
}

}  // namespace

Points::Points(ObjectReader& o)
    : i(o.vec3("s_bar_p_i",
               {"Position of point P relative to the centre of mass of body i [m], in the frame of body i.",
                "[0, 0.1, 0]"},
               Vec3::Zero())),
      j(o.vec3("s_bar_q_j",
               {"Position of point Q relative to the centre of mass of body j [m], in the frame of body j.",
                "[0, -0.2, 0]"},
               Vec3::Zero()))
{}

Axes::Axes(ObjectReader& o)
    : i(o.direction("axis_bar_i", {"Axis of the joint [-], in the frame of body i.", "[1, 0, 0]"})),
      j(o.direction("axis_bar_j", {"Axis of the joint [-], in the frame of body j.", "[1, 0, 0]"}))
{}

Driver read_value(ObjectReader& o, const About& about, const std::optional<std::string>& fallback)
{
    for (const char* key : {"f_dot", "f_ddot"}) {
        o.note(key, R"("deprecated": true)",
               {"Accepted for compatibility with the published files of the dissertation and ignored with a "
                "warning: derivatives of f are computed exactly."});
        o.find(key);
    }
    return read_driver(o, "f", about, fallback);
}

Driver read_driver(ObjectReader& o, std::string_view key, const About& about,
                   const std::optional<std::string>& fallback)
{
    const Json by_default = fallback ? Json(*fallback) : Json();
    o.note(key, R"("$ref": "#/$defs/motion")", about, fallback ? &by_default : nullptr);
    if (const Json* v = o.peek(key); v != nullptr && v->members() != nullptr) return read_samples(o, key);
    const std::string text = o.formula(key, {}, fallback);
    try {
        Driver f(text);
        const io::Jet start = f.jet(0);
        if (!std::isfinite(f.f(0)) || !std::isfinite(start.fdot) || !std::isfinite(start.fddot))
            o.fail(key, std::string(key) + " and its derivatives must be finite at t = 0, got " +
                            described(text) + " with the value " + shortest(f.f(0)) +
                            " and the derivatives " + shortest(start.fdot) + ", " + shortest(start.fddot));
        return f;
    } catch (const io::ExpressionError& e) {
        o.fail(key, e.what());
    }
}

std::string type_with_other_name(const std::string& name)
{
    static const std::map<std::string, std::string> known = {{"prismatic", "translational"},
                                                             {"slider", "translational"},
                                                             {"hinge", "revolute"},
                                                             {"pin", "revolute"},
                                                             {"ball", "spherical"},
                                                             {"ball-and-socket", "spherical"},
                                                             {"cardan", "universal"},
                                                             {"hooke", "universal"},
                                                             {"weld", "fixed"},
                                                             {"rigid", "fixed"},
                                                             {"rod", "distance"},
                                                             {"link", "distance"},
                                                             {"helical", "screw"},
                                                             {"motor", "hinge-driver"},
                                                             {"spring", "spring-damper"},
                                                             {"damper", "spring-damper"},
                                                             {"tsda", "spring-damper"},
                                                             {"rsda", "torsion-spring"},
                                                             {"moment", "torque"}};
    std::string lower = name;
    std::transform(lower.begin(), lower.end(), lower.begin(),
                   [](unsigned char c) { return c == '_' ? '-' : static_cast<char>(std::tolower(c)); });
    const auto found = known.find(lower);
    return found != known.end() ? found->second : "";
}

std::string unique_name(ObjectReader& o, const std::string& kind, std::set<std::string>& used,
                        const About& about)
{
    std::string name = o.name("name", about, kind + "-" + std::to_string(used.size() + 1));
    if (!used.insert(name).second) o.fail("name", "this name is already used, got " + described(name));
    return name;
}

namespace {

// A function-local variable is initialised before its first use, also during static initialisation.
ReadContacts& registered()
{
    static ReadContacts read = nullptr;
    return read;
}

}  // namespace

bool register_contact_reader(ReadContacts read)
{
    registered() = read;
    return true;
}

ReadContacts contact_reader() { return registered(); }

}  // namespace hilda::dae

template class hilda::io::Registry<hilda::dae::ConstraintType>;
template class hilda::io::Registry<hilda::dae::ForceType>;
