// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/cosim/cosim_file.hpp"

#include "io/error.hpp"
#include "io/files.hpp"
#include "io/object_reader.hpp"
#include "io/schema/schema_recorder.hpp"
#include "run/named_model.hpp"
#include "run/watch/run_check.hpp"

#include <filesystem>

namespace hilda::run {

namespace {

CosimPair read_pair(io::ObjectReader o)
{
    o.defines(
        "pair", "Pair",
        "A body of the model and a boundary of the case, which moves rigidly with the body. Its mass is that "
        "of the body.");
    CosimPair pair{
        .body = o.name("body", {"Name of the body.", R"("ball")"}), .boundary = {}, .place = o.place()};
    pair.boundary = o.name("boundary",
                           {.text = "Name of the boundary. By default that of the body.",
                            .example = R"("ball")",
                            .computed = true},
                           pair.body);
    if (o.given("r")) {
        const std::vector<double> r = o.numbers(
            "r", 3,
            {"Place of r of the boundary relative to the centre of mass of the body, in the body frame [m].",
             "[0, 0, 0.1]", R"("default": [0, 0, 0])"});
        pair.r = {r[0], r[1], r[2]};
    }
    o.finish();
    return pair;
}

void read_pairs(io::ObjectReader& o, CosimFile& f)
{
    const io::Json::List& pairs =
        o.list("pairs", true,
               {"Bodies and the boundaries that they move.", R"([{"body": "ball"}])",
                R"("minItems": 1, "items": {"$ref": "#/$defs/pair"})"});
    for (std::size_t k = 0; k < pairs.size(); ++k)
        f.pairs.push_back(read_pair({f.source, pairs[k], "/pairs/" + std::to_string(k)}));
    if (f.pairs.empty()) o.fail("pairs", "pairs must list at least one body and boundary, got none");
    for (std::size_t k = 0; k < f.pairs.size(); ++k)
        for (std::size_t m = 0; m < k; ++m)
            if (f.pairs[k].body == f.pairs[m].body || f.pairs[k].boundary == f.pairs[m].boundary)
                o.fail("pairs", k,
                       "two pairs have the same body or boundary, got '" + f.pairs[k].body + "' and '" +
                           f.pairs[k].boundary + "'");
}

/// `name` is the default of the key "name".
void read_keys(io::ObjectReader& o, const std::string& name, CosimFile& f)
{
    o.defines("cosim", "Co-simulation", "A mechanism and grains that act on each other.");
    o.allow_schema(
        {"Path or address of the JSON schema, for editors. It has no effect.", R"("../cosim.schema.json")"});
    o.note("hilda_cosim", R"("const": 1)", {"Version of the format.", "1"});
    o.version("hilda_cosim");
    f.name = o.name(
        "name",
        {.text = "Name of the run and of its default output directory, without /. By default that of the "
                 "file.",
         .example = R"("strike")",
         .computed = true},
        name);
    if (f.name.find('/') != std::string::npos || f.name == "." || f.name == "..")
        o.fail("name", "name must be the name of a directory, without /, got " + io::in_quotes(f.name));
    f.model = o.file(
        "model",
        {"Path of the model of the mechanism, relative to this file. It must be below the folder of this "
         "file, unless --allow-paths is given.",
         R"("pendulum.json")"});
    f.granular_case = o.file("case", {"Path of the granular case, relative to this file, as that of the "
                                      "model. Its end is that of this file.",
                                      R"("bed.json")"});
    f.substeps = o.count(
        "substeps",
        {"Number k of steps of the grains in a step of the mechanism: H = k h.", "10", R"("minimum": 1)"}, 1);
    if (f.substeps < 1) o.fail("substeps", "substeps must be positive, got 0");
    f.end = o.positive("end", {"End of the run [s].", "0.3"});
    if (o.given("interval"))
        f.interval =
            o.positive("interval", {"Time between rows of the mechanism [s]. By default end/1000.", "0.001"});
    f.integrator = o.one_of("integrator", {"rA-half-1-momentum", "rA-half-1-kick"},
                            {"Integrator of the mechanism.", R"("rA-half-1-kick")"}, default_integrator);
    read_pairs(o, f);
    o.finish();
}

}  // namespace

CosimFile read_cosim(const std::string& path, const std::vector<std::string>& set, bool allow_paths)
{
    io::JsonSource source(io::read_file(path, io::JsonSource::max_bytes), path);
    source.base = std::filesystem::path(path).parent_path().string();
    if (!allow_paths) source.within = std::filesystem::absolute(path).parent_path().string();
    for (const std::string& change : set) source.set(change, "--set");
    CosimFile f{.source = source};
    io::ObjectReader o(f.source, f.source.root, "");
    read_keys(o, std::filesystem::path(path).stem().string(), f);
    return f;
}

io::Json cosim_schema()
{
    io::SchemaRecorder recorder;
    recorder.kinds["name"] = {{"type", "string"}, {"minLength", 1}};
    recorder.kinds["note"] = {{"description", "Comment, without effect."}, {"type", "string"}};
    recorder.shown = {"cosim", "pair"};
    CosimFile f{.source = {R"({"hilda_cosim": 1, "model": "pendulum.json", "case": "bed.json", "end": 0.3, )"
                           R"("pairs": [{"body": "ball"}]})",
                           "example of a co-simulation"}};
    f.source.schema = &recorder;
    io::ObjectReader o(f.source, f.source.root, "");
    read_keys(o, "example", f);
    return recorder.schema("cosim");
}

bool is_cosim_file(const std::string& path)
{
    if (!is_model_path(path)) return false;
    try {
        std::string text = io::read_file(path, io::JsonSource::max_bytes);
        const auto has = [&](const char* part) { return text.find(part) != std::string::npos; };
        if (!has("hilda_cosim") && !has("\\u")) return false;  // a large model is not parsed twice
        const io::JsonSource source(std::move(text), path);
        return source.root.member("hilda_cosim") != nullptr;
    } catch (const io::Failure&) {
        return false;
    }
}

}  // namespace hilda::run
