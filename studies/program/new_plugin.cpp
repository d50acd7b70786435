// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/new_plugin.hpp"

#include "io/error.hpp"
#include "io/files.hpp"
#include "io/nearest.hpp"
#include "io/program.hpp"
#include "lie/schemes.hpp"
#include "run/cosim/grains.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iostream>
#include <vector>

namespace hilda::studies {

// The files of examples/plugin and examples/plugin-granular-law
extern const char plugin_scheme_text[], plugin_cmake_text[];
extern const char law_cmake_text[], law_header_text[], law_case_text[], law_readme_text[];

namespace {

/// A file of a new plug-in. In its name and in its text, my-scheme or my-law, my_law and MyLaw stand for the
/// name.
struct FileToWrite {
    std::string name;
    const char* text;
};

struct Kind {
    std::string name, word;
    std::vector<FileToWrite> files;
    const char* commands;  ///< {0}: directory, {1}: name
};

const std::vector<Kind>& kinds()
{
    static const std::vector<Kind> all = {
        {.name = "integrator",
         .word = "my-scheme",
         .files = {{"scheme.cpp", plugin_scheme_text}, {"CMakeLists.txt", plugin_cmake_text}},
         .commands = "written: {0}/scheme.cpp, an integrator of second order, and {0}/CMakeLists.txt\n\n"
                     "  cmake -S {0} -B {0}/build -D CMAKE_BUILD_TYPE=Release -D CMAKE_PREFIX_PATH=PREFIX\n"
                     "  cmake --build {0}/build\n"
                     "  hilda --load {0}/build/{1}.so study convergence --integrator rA-half-2,{1}\n\n"
                     "PREFIX: the build folder of HILDA, build/release, or where it is installed. "
                     "docs/extending/integrator.md describes the interface.\n"},
        {.name = "granular-law",
         .word = "my-law",
         .files = {{"normal/my_law.hpp", law_header_text},
                   {"CMakeLists.txt", law_cmake_text},
                   {"head_on.json", law_case_text},
                   {"README.md", law_readme_text}},
         .commands = "written in {0}: normal/, a normal law, CMakeLists.txt, README.md, and head_on.json, a "
                     "collision\n\n"
                     "  cmake -S {0} -B {0}/build -D CMAKE_BUILD_TYPE=Release -D CMAKE_PREFIX_PATH=PREFIX\n"
                     "  cmake --build {0}/build\n"
                     "  {0}/build/{1}-granular {0}/head_on.json --output {0}/out\n\n"
                     "PREFIX: the build folder of HILDA, build/release, or where it is installed. "
                     "docs/extending/granular-law.md describes the interface.\n"}};
    return all;
}

const Kind& kind_named(const std::string& name)
{
    std::vector<std::string> known;
    for (const Kind& kind : kinds()) {
        if (kind.name == name) return kind;
        known.push_back(kind.name);
    }
    throw io::UsageError("new: unknown kind" + io::with_nearest(name, known) +
                         fmt::format("; known: {}. docs/extending shows the others", fmt::join(known, ", ")));
}

void check_name(const Kind& kind, const std::string& name)
{
    const bool valid = !name.empty() && std::isalpha(static_cast<unsigned char>(name[0])) != 0 &&
                       std::all_of(name.begin(), name.end(), [](unsigned char c) {
                           return std::isalnum(c) != 0 || c == '-' || c == '_';
                       });
    if (!valid)
        throw io::UsageError(
            "new: NAME must begin with a letter and contain letters, digits, - and _ only, got '" + name +
            "'");
    if (kind.name == "granular-law") {
        const std::vector<std::string> laws = run::grains("new granular-law").law_names("normal");
        if (std::find(laws.begin(), laws.end(), name) != laws.end())
            throw io::UsageError("new: there is a normal law '" + name + "'; choose another name");
        return;
    }
    for (const lie::Scheme& scheme : lie::schemes())
        if (scheme.name == name)
            throw io::UsageError("new: there is an integrator '" + name + "'; choose another name");
}

std::string replaced(std::string text, const std::string& word, const std::string& name)
{
    for (size_t at = 0; (at = text.find(word, at)) != std::string::npos; at += name.size())
        text.replace(at, word.size(), name);
    return text;
}

/// my-law to my_law
std::string with_underscores(std::string name)
{
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

/// my-law to MyLaw
std::string in_camel_case(const std::string& name)
{
    std::string camel;
    bool begins = true;
    for (const char c : name) {
        const bool joins = c == '-' || c == '_';
        if (!joins) camel += begins ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
        begins = joins;
    }
    return camel;
}

}  // namespace

int new_plugin(const std::string& kind_name, const std::string& name, const std::string& output)
{
    const Kind& kind = kind_named(kind_name);
    check_name(kind, name);
    const std::string directory = output.empty() ? name : output;
    io::check_output_directory(directory, false, "choose another --output");
    for (const FileToWrite& file : kind.files) {
        const auto named = [&](std::string text) {
            text = replaced(std::move(text), in_camel_case(kind.word), in_camel_case(name));
            text = replaced(std::move(text), with_underscores(kind.word), with_underscores(name));
            return replaced(std::move(text), kind.word, name);
        };
        const std::string path = directory + '/' + named(file.name);
        io::make_directory(std::filesystem::path(path).parent_path().string());
        io::write_file(path, named(file.text));
    }
    std::cout << fmt::format(fmt::runtime(kind.commands), directory, name);
    return io::exit_code::done;
}

}  // namespace hilda::studies
