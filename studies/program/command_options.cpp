// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/command_options.hpp"

#include "studies/program/arguments.hpp"

namespace hilda::studies {

std::string unchanged(const std::string& /*option*/, const std::string& text) { return text; }

CLI::Option* value(CLI::App& command, const std::string& name, const std::string& kind,
                   const std::string& what, const Setter& set)
{
    return command
        .add_option_function<std::string>(
            name, [name, set](const std::string& text) { set(name, text); }, what)
        ->type_name(kind);
}

void values(CLI::App& command, const std::string& name, const std::string& kind, const std::string& what,
            const Setter& set)
{
    command
        .add_option_function<std::vector<std::string>>(
            name,
            [name, set](const std::vector<std::string>& all) {
                for (const std::string& text : all) set(name, text);
            },
            what)
        ->type_name(kind)
        ->allow_extra_args(false);
}

void add_option(CLI::App& command, const io::Option& option, bool repeatable, const Setter& set)
{
    if (option.is_switch())
        command.add_flag_callback(
            option.name, [set, name = option.name] { set(name, ""); }, option.help);
    else if (repeatable)
        values(command, option.name, option.value, option.help, set);
    else
        value(command, option.name, option.value, option.help, set);
}

void add_settings(CLI::App& command, lie::Settings& settings, std::vector<std::string>& given)
{
    for (const run::SettingOption& option : run::setting_options())
        add_option(command, option, false,
                   [&settings, &given, read = option.set](const std::string& name, const std::string& text) {
                       given.push_back(name);
                       read(settings, name, text);
                   });
}

void add_model(CLI::App& command, std::string& to)
{
    command.add_option("MODEL", to, "path of a model file, or name of a built-in model")
        ->required()
        ->type_name("");
}

std::string help_of_set(const std::string& what) { return "change one entry of " + what + "; repeatable"; }

void add_set(CLI::App& command, const std::string& what, std::vector<std::string>& to)
{
    values(command, "--set", "/json/pointer=VALUE", help_of_set(what), append_one(to, setting));
}

std::string help_of_normal_rows(const std::string& default_rows)
{
    return "tangent vectors in the normal equations of contact constraints; fixed-xy is singular for a "
           "normal "
           "in the x-y plane; default: " +
           default_rows;
}

void add_normal_rows(CLI::App& command, const std::string& default_rows, std::string& to)
{
    value(command, "--normal-rows", "tangent|fixed-xy", help_of_normal_rows(default_rows),
          assign(to, normal_rows));
}

std::string help_of_allow_paths(const std::string& of)
{
    return "read the files that " + of + " names also if they are not below its folder";
}

void add_allow_paths(CLI::App& command, const std::string& of, bool& to)
{
    command.add_flag("--allow-paths", to, help_of_allow_paths(of));
}

std::string help_of_fix_initial(const std::string& and_more)
{
    return "project inconsistent initial data onto the constraints" + and_more;
}

void add_fix_initial(CLI::App& command, const std::string& and_more, bool& to)
{
    command.add_flag("--fix-initial", to, help_of_fix_initial(and_more));
}

std::string help_of_output(const std::string& accepted_by, const std::string& default_directory)
{
    return "output directory, new or empty unless " + accepted_by +
           " is given; default: " + default_directory;
}

void add_output(CLI::App& command, const std::string& accepted_by, const std::string& default_directory,
                std::string& to)
{
    value(command, "--output", "DIR", help_of_output(accepted_by, default_directory), assign(to, io::path));
}

std::string help_of_figure_format() { return "formats of the figures, such as png,pdf,svg; default: png"; }

void add_figure_format(CLI::App& command, std::vector<std::string>& to)
{
    value(command, "--figure-format", "F[,F...]", help_of_figure_format(), assign(to, formats_of_figures));
}

void add_no_plot(CLI::App& command, const std::string& what, bool& plot)
{
    command.add_flag_callback(
        "--no-plot", [&plot] { plot = false; }, what);
}

}  // namespace hilda::studies
