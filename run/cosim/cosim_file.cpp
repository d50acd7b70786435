// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/cosim/cosim_file.hpp"

#include "io/error.hpp"
#include "io/files.hpp"
#include "io/object_reader.hpp"
#include "run/named_model.hpp"
#include "run/watch/run_check.hpp"

#include <filesystem>

namespace hilda::run {

namespace {

CosimPair read_pair(const io::JsonSource& source, const io::Json& value, const std::string& pointer)
{
    io::ObjectReader o(source, value, pointer);
    CosimPair pair{.body = o.name("body"), .boundary = {}, .place = o.place()};
    pair.boundary = o.name("boundary", {}, pair.body);
    if (o.has("r")) {
        const std::vector<double> r = o.numbers("r", 3);
        pair.r = {r[0], r[1], r[2]};
    }
    o.finish();
    return pair;
}

}  // namespace

CosimFile read_cosim(const std::string& path, const std::vector<std::string>& set)
{
    io::JsonSource source(io::read_file(path, io::JsonSource::max_bytes), path);
    source.base = std::filesystem::path(path).parent_path().string();
    for (const std::string& change : set) source.set(change, "--set");
    CosimFile f{.source = source};
    io::ObjectReader o(f.source, f.source.root, "");
    o.version("hilda_cosim");
    o.allow_schema();
    f.name = o.name("name", {}, std::filesystem::path(path).stem().string());
    f.model = o.file("model");
    f.granular_case = o.file("case");
    f.substeps = o.count("substeps", {}, 1);
    if (f.substeps < 1) o.fail("substeps", "substeps must be positive, got 0");
    f.end = o.positive("end");
    if (o.has("interval")) f.interval = o.positive("interval");
    f.integrator = o.one_of("integrator", {"rA-half-1-momentum", "rA-half-1-kick"}, {}, default_integrator);
    const io::Json::List& pairs = o.list("pairs", true);
    for (std::size_t k = 0; k < pairs.size(); ++k)
        f.pairs.push_back(read_pair(f.source, pairs[k], "/pairs/" + std::to_string(k)));
    if (f.pairs.empty()) o.fail("pairs", "pairs must list at least one body and boundary, got none");
    for (std::size_t k = 0; k < f.pairs.size(); ++k)
        for (std::size_t m = 0; m < k; ++m)
            if (f.pairs[k].body == f.pairs[m].body || f.pairs[k].boundary == f.pairs[m].boundary)
                o.fail("pairs", k,
                       "two pairs have the same body or boundary, got '" + f.pairs[k].body + "' and '" +
                           f.pairs[k].boundary + "'");
    o.finish();
    return f;
}

bool is_cosim_file(const std::string& path)
{
    if (!is_model_path(path)) return false;
    try {
        const io::JsonSource source(io::read_file(path, io::JsonSource::max_bytes), path);
        return source.root.member("hilda_cosim") != nullptr;
    } catch (const io::Failure&) {
        return false;
    }
}

}  // namespace hilda::run
