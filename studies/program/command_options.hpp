// SPDX-License-Identifier: GPL-3.0-or-later
/// Options of commands: how they set a value, and those that several commands have.

#pragma once

#include "io/option_values.hpp"
#include "lie/settings.hpp"

#include <CLI/CLI.hpp>

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace hilda::studies {

/// Reads the text of an option and stores its value. io::UsageError for an invalid text.
using Setter = std::function<void(const std::string& option, const std::string& text)>;

/// Stores read(option, text).
template <class Goal, class Read>
Setter assign(Goal& to, Read read)
{
    return [&to, read](const std::string& option, const std::string& text) { to = read(option, text); };
}
/// Appends the elements of the list read(option, text).
template <class List, class Read>
Setter append(List& to, Read read)
{
    return [&to, read](const std::string& option, const std::string& text) {
        for (auto& item : read(option, text)) to.push_back(std::move(item));
    };
}
/// Appends read(option, text).
template <class List, class Read>
Setter append_one(List& to, Read read)
{
    return
        [&to, read](const std::string& option, const std::string& text) { to.push_back(read(option, text)); };
}
/// A value that is not checked here
std::string unchanged(const std::string& option, const std::string& text);

/// Adds an option with one value, which may be given once. `kind` stands for the value in the help.
CLI::Option* value(CLI::App& command, const std::string& name, const std::string& kind,
                   const std::string& what, const Setter& set);
/// Adds an option with one value, which may be given repeatedly.
void values(CLI::App& command, const std::string& name, const std::string& kind, const std::string& what,
            const Setter& set);

/// Adds an option of a table; a switch has the text "".
void add_option(CLI::App& command, const io::Option& option, bool repeatable, const Setter& set);

/// Adds all of run::setting_options(); `given` receives the names of those that were given.
void add_settings(CLI::App& command, lie::Settings& settings, std::vector<std::string>& given);

/// Adds the argument MODEL, which must be given.
void add_model(CLI::App& command, std::string& to);
/// Adds --set for entries of `what`, such as "the model".
void add_set(CLI::App& command, const std::string& what, std::vector<std::string>& to);
void add_normal_rows(CLI::App& command, const std::string& default_rows, std::string& to);
/// Adds --allow-paths; `of` is what names the files, such as "the model".
void add_allow_paths(CLI::App& command, const std::string& of, bool& to);
/// Adds --fix-initial; `and_more` is the end of the help text.
void add_fix_initial(CLI::App& command, const std::string& and_more, bool& to);
/// Adds --output; `accepted_by` are the options that accept a directory that is not empty.
void add_output(CLI::App& command, const std::string& accepted_by, const std::string& default_directory,
                std::string& to);
void add_figure_format(CLI::App& command, std::vector<std::string>& to);
/// Adds --no-plot.
void add_no_plot(CLI::App& command, const std::string& what, bool& plot);

// The help of these options
std::string help_of_set(const std::string& what);
std::string help_of_normal_rows(const std::string& default_rows);
std::string help_of_allow_paths(const std::string& of);
std::string help_of_fix_initial(const std::string& and_more);
std::string help_of_output(const std::string& accepted_by, const std::string& default_directory);
std::string help_of_figure_format();

}  // namespace hilda::studies
