// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/new_plugin.hpp"

#include "io/error.hpp"
#include "io/files.hpp"
#include "io/nearest.hpp"
#include "io/program.hpp"
#include "lie/schemes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <iostream>

namespace hilda::studies {

extern const char plugin_scheme_text[];  // examples/plugin/scheme.cpp
extern const char plugin_cmake_text[];   // examples/plugin/CMakeLists.txt

namespace {

void check(const std::string& kind, const std::string& name)
{
    if (kind != "integrator")
        throw io::UsageError("new: unknown kind" +
                             io::with_nearest(kind, std::vector<std::string>{"integrator"}) +
                             "; integrator is the only one. docs/extending shows the others");
    const bool valid = !name.empty() && std::isalpha(static_cast<unsigned char>(name[0])) != 0 &&
                       std::all_of(name.begin(), name.end(), [](unsigned char c) {
                           return std::isalnum(c) != 0 || c == '-' || c == '_';
                       });
    if (!valid)
        throw io::UsageError(
            "new: NAME must begin with a letter and contain letters, digits, - and _ only, got '" + name +
            "'");
    for (const lie::Scheme& scheme : lie::schemes())
        if (scheme.name == name)
            throw io::UsageError("new: there is an integrator '" + name + "'; choose another name");
}

std::string with_name(std::string text, const std::string& name)
{
    const std::string name_in_template = "my-scheme";
    for (size_t at = 0; (at = text.find(name_in_template, at)) != std::string::npos; at += name.size())
        text.replace(at, name_in_template.size(), name);
    return text;
}

}  // namespace

int new_plugin(const std::string& kind, const std::string& name, const std::string& output)
{
    check(kind, name);
    const std::string directory = output.empty() ? name : output;
    io::check_output_directory(directory, false, "choose another --output");
    io::make_directory(directory);
    io::write_file(directory + "/scheme.cpp", with_name(plugin_scheme_text, name));
    io::write_file(directory + "/CMakeLists.txt", with_name(plugin_cmake_text, name));
    std::cout << fmt::format(
        "written: {0}/scheme.cpp, an integrator of second order, and {0}/CMakeLists.txt\n\n"
        "  cmake -S {0} -B {0}/build -D CMAKE_BUILD_TYPE=Release -D CMAKE_PREFIX_PATH=PREFIX\n"
        "  cmake --build {0}/build\n"
        "  hilda --load {0}/build/{1}.so study convergence --integrator rA-half-2,{1}\n\n"
        "PREFIX: where HILDA is installed (cmake --install). docs/extending/integrator.md describes the "
        "interface.\n",
        directory, name);
    return io::exit_code::done;
}

}  // namespace hilda::studies
