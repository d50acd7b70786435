// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/lists.hpp"

#include "dae/model_schema.hpp"
#include "io/error.hpp"
#include "io/files.hpp"
#include "io/json.hpp"
#include "io/json_source.hpp"
#include "io/option_values.hpp"
#include "lie/features.hpp"
#include "lie/integrator.hpp"
#include "lie/schemes.hpp"
#include "run/cosim/cosim_file.hpp"
#include "studies/framework/problem.hpp"
#include "studies/framework/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iostream>

namespace hilda::studies {

namespace {

using Line = std::vector<std::string>;

/// Prints left-aligned columns, separated by two blanks; two columns in lines of at most 100 characters
void print_aligned(const std::vector<Line>& lines)
{
    std::vector<size_t> width;
    for (const Line& line : lines) {
        width.resize(std::max(width.size(), line.size()));
        for (size_t c = 0; c < line.size(); ++c) width[c] = std::max(width[c], line[c].size());
    }
    std::string text;
    for (const Line& line : lines) {
        for (size_t c = 0; c + 1 < line.size(); ++c) text += fmt::format("{:<{}}  ", line[c], width[c]);
        text += line.back() + '\n';
    }
    std::cout << (width.size() == 2 ? io::wrapped_help(text) : text);
}

/// Prints JSON objects with these keys, or aligned lines without the keys
void show(bool json, const Line& keys, const std::vector<Line>& lines)
{
    if (!json) return print_aligned(lines);
    io::Json all = io::Json::array();
    for (const Line& line : lines) {
        io::Json one;
        for (size_t c = 0; c < keys.size(); ++c) one[keys[c]] = line[c];
        all.push_back(one);
    }
    std::cout << all.text();
}

}  // namespace

int list_models(bool json)
{
    std::vector<Line> lines;
    for (const Problem& p : problems()) lines.push_back({p.name, p.what});
    show(json, {"name", "what"}, lines);
    return io::exit_code::done;
}

namespace {

std::string text_of(const Problem& p) { return p.model.ends_with('\n') ? p.model : p.model + '\n'; }

std::string file_in(const std::string& folder, const std::string& name)
{
    return (std::filesystem::path(folder) / (name + ".json")).string();
}

/// Throws io::UsageError for a file in a folder with another text, which may be a model that a user has
/// changed.
void check_replaceable(const std::string& file, const std::string& text)
{
    std::error_code error;
    if (std::filesystem::is_regular_file(file, error) &&
        io::read_file(file, io::JsonSource::max_bytes) != text)
        throw io::UsageError("models: --write: " + file +
                             " exists and is another model; remove it, or choose another name");
}

}  // namespace

int write_model(const std::string& name, const std::string& to)
{
    const std::string text = text_of(problem(name));
    std::error_code error;
    if (to.empty()) {
        std::cout << text;
        return io::exit_code::done;
    }
    const bool is_folder = std::filesystem::is_directory(to, error);
    if (is_folder) check_replaceable(file_in(to, name), text);
    io::write_named_file(is_folder ? file_in(to, name) : to, text);
    return io::exit_code::done;
}

int write_models(const std::string& folder)
{
    if (folder.ends_with(".json"))
        throw io::UsageError("models: --write without NAME writes all models to a folder; '" + folder +
                             "' is the name of a file");
    for (const Problem& p : problems()) check_replaceable(file_in(folder, p.name), text_of(p));
    io::make_directory(folder);
    for (const Problem& p : problems()) io::write_file(file_in(folder, p.name), text_of(p));
    std::cout << fmt::format("written {} models to {}\n", problems().size(), folder);
    return io::exit_code::done;
}

int list_integrators(bool json)
{
    if (json) {
        io::Json all = io::Json::array();
        for (const lie::Scheme& s : lie::schemes())
            all.push_back({{"name", s.name},
                           {"description", s.description},
                           {"order", s.adaptive ? io::Json() : io::Json(s.order)},
                           {"order_lambda", s.adaptive ? io::Json() : io::Json(s.order_lambda)},
                           {"adaptive", s.adaptive},
                           {"adaptive_without_step", s.with_adaptive_steps().adaptive},
                           {"supports", lie::keys_of(s.supports)},
                           {"formulation", s.formulation},
                           {"unknowns", s.unknowns},
                           {"options", s.with_adaptive_steps().option_names()},
                           {"source", s.source}});
        std::cout << all.text();
        return io::exit_code::done;
    }
    std::vector<Line> lines = {
        {"name", "order", "of lambda", "formulation", "description", "unknowns", "source", "supports"}};
    for (const lie::Scheme& s : lie::schemes())
        lines.push_back({s.name, s.adaptive ? "adaptive" : std::to_string(s.order),
                         s.adaptive ? "-" : std::to_string(s.order_lambda), s.formulation, s.description,
                         s.unknowns, s.source, fmt::format("{}", fmt::join(lie::keys_of(s.supports), ", "))});
    print_aligned(lines);
    std::cout << "\nsupports: what an integrator supports besides holonomic constraints.\n";
    for (const lie::FeatureText& f : lie::all_features())
        std::cout << fmt::format("  {}: {}\n", f.key, f.text);
    std::cout << "The default is rA-half-1-momentum; hilda check names the integrator that suits a model.\n";
    return io::exit_code::done;
}

int list_studies(bool json)
{
    std::vector<Line> lines;
    for (const Study& s : studies()) lines.push_back({s.name, s.answers});
    show(json, {"kind", "answers"}, lines);
    return io::exit_code::done;
}

int print_schema(bool of_cosim)
{
    std::cout << io::written(of_cosim ? run::cosim_schema() : dae::model_schema()) << '\n';
    return io::exit_code::done;
}

}  // namespace hilda::studies
