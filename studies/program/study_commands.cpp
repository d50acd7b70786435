// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/study_commands.hpp"

#include "studies/framework/study.hpp"
#include "studies/program/arguments.hpp"
#include "studies/program/command_options.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace hilda::studies {

void add_study_options(CLI::App& c, std::string& kind, StudyArguments& to)
{
    c.add_option("KIND", kind, "name of the study; default: print the list")->type_name("");
    c.add_option_function<std::vector<std::string>>(
         "MODEL",
         [&to](const std::vector<std::string>& all) {
             to.options.given.emplace_back("--problem");
             to.options.problems.insert(to.options.problems.end(), all.begin(), all.end());
         },
         "built-in models or model files, as --problem")
        ->type_name("");
    for (const StudyOption& option : study_options())
        add_option(c, option, option.repeatable,
                   [&to, read = option.read](const std::string& name, const std::string& text) {
                       to.options.given.push_back(name);
                       read(to, name, text);
                   });
    to.draw = draw_figures;
}

void add_fit_options(CLI::App& c, FitOptions& to)
{
    add_model(c, to.model);
    value(c, "--data", "FILE", "CSV file with the column t [s] and columns of the outputs of a run",
          assign(to.data, io::path))
        ->required();
    values(c, "--parameter", "/json/pointer[=START[:LOW:HIGH[:SCALE]]]",
           "a number of the model that is fitted, with its start (default: that of the model), bounds and "
           "typical change; repeatable",
           append_one(to.parameters, unchanged));
    values(c, "--column", "NAME[,NAME...]", "columns of the data; default: all", append(to.columns, list));
    values(c, "--sigma", "S or COLUMN=S",
           "standard deviation of the data, of all columns or of one; default: the same for all columns, and "
           "estimated from the residuals",
           append_one(to.sigma, unchanged));
    value(c, "--integrator", "NAME", "integrator; default: " + to.integrator,
          assign(to.integrator, integrator));
    value(c, "--step", "H", "step size [s] of an integrator with fixed steps; default: 1e-3",
          assign(to.step, positive_number));
    add_settings(c, to.settings, to.given_settings);
    add_set(c, "the model", to.set);
    add_fix_initial(c, "", to.fix_initial);
    add_allow_paths(c, "the model", to.allow_paths);
    value(c, "--max-fit-iterations", "N", "largest number of iterations of the fit (default 100)",
          assign(to.max_fit_iterations, positive_count));
    add_output(c, "--force", "out/fit-NAME", to.output);
    c.add_flag("--force", to.force, "overwrite an output directory that is not empty");
    value(c, "--jobs", "N", "number of concurrent runs; default: the number of cores",
          assign(to.jobs, positive_count));
    add_no_plot(c, "draw no figure", to.plot);
    add_figure_format(c, to.figure_formats);
    c.add_flag("--json", to.json, "print the result as JSON on stdout; write files only with --output");
    c.add_flag("--quiet", to.quiet, "print no result, no warnings and no progress");
}

void restrict_help(CLI::App& command, const Study& to)
{
    const std::vector<StudyOption> options = study_options();
    const auto is_of_study = [&](const std::string& name) {
        const auto known = std::find_if(options.begin(), options.end(),
                                        [&](const StudyOption& option) { return option.name == name; });
        return known == options.end() || known->is_of(to);
    };
    for (CLI::Option* option : command.get_options())
        if (option->get_name() == "KIND" || !is_of_study(option->get_name()) ||
            (option->get_name() == "MODEL" && !is_of_study("--problem")) ||
            (option->get_name() == "--expect" && to.keys.empty()))
            command.remove_option(option);
    command.name("study " + to.name);
    command.description(to.answers);
    std::vector<std::string> files = {"study.csv", "study.json"};
    files.insert(files.end(), to.files.begin(), to.files.end());
    command.footer((to.keys.empty() ? "" : fmt::format("Keys of --expect: {}\n", fmt::join(to.keys, ", "))) +
                   fmt::format("Files: {}\n", fmt::join(files, ", ")) +
                   "Words in capitals stand for names; docs/guide/outputs.md describes the columns.");
}

void add_reproduce_options(CLI::App& c, ReproduceOptions& o)
{
    values(c, "--chapter", "N[,N...]", "chapters 3, 4, 5, 7, 8; default: all",
           append(o.chapters, [](const std::string& option, const std::string& text) {
               std::vector<int> chapters;
               for (const std::string& part : list(option, text))
                   chapters.push_back(io::count_up_to(99, option, part));
               return chapters;
           }));
    c.add_flag("--quick", o.quick, "reduced grids, about half an hour of CPU time (the default)");
    c.add_flag("--full", o.full, "the grids of the dissertation, hours");
    add_output(c, "--force or --resume", "out/reproduce", o.output);
    c.add_flag("--resume", o.resume, "continue in the output directory; finished studies are not run again");
    c.add_flag("--force", o.force, "overwrite an output directory that is not empty");
    value(c, "--jobs", "N", "number of concurrent runs; default: the number of cores",
          assign(o.jobs, positive_count));
    add_no_plot(c, "draw no figures", o.plot);
    c.add_flag("--quiet", o.quiet, "print no result and no progress");
}

void add_plot_options(CLI::App& c, std::string& directory, FigureOptions& figures)
{
    c.add_option("DIR", directory, "output directory of a run or a study")->required()->type_name("");
    add_figure_format(c, figures.formats);
    values(
        c, "--integrator", "NAME[,NAME...]",
        "integrators to show, of those in the table; default: at most eight, those of the dissertation first",
        append(figures.integrators, list));
    values(c, "--quantity", "NAME[,NAME...]",
           "quantities to show, such as r,v,omega; default: all. An unknown name lists those of the figure",
           append(figures.quantities, list));
}

void add_view_options(CLI::App& c, ViewOptions& to)
{
    c.add_option("DIR", to.directory, "output directory of a run, a co-simulation or a granular run")
        ->required()
        ->type_name("");
    value(c, "--output", "FILE", "the page or video; default: view.html or view.mp4 in DIR",
          assign(to.output, io::path));
    value(c, "--frames", "N", "show at most N rows or frames, evenly chosen (default 1000)",
          assign(to.frames, [](const std::string& option, const std::string& text) {
              return io::count_up_to(100000, option, text);
          }));
    c.add_flag("--mp4", to.video, "write a video, by Chromium and ffmpeg, instead of the page");
    value(c, "--seconds", "S",
          "duration of the video; default: that of the run if it is from 3 to 30 s, otherwise 10",
          assign(to.seconds, [](const std::string& option, const std::string& text) {
              constexpr double most = 3600;
              const double seconds = positive_number(option, text);
              if (seconds > most) io::refuse_option(option, "must be at most 3600 s", text);
              return seconds;
          }));
    c.add_flag("--serve", to.serve,
               "serve the page on 127.0.0.1 until Ctrl-C; it follows a run that goes on");
    value(c, "--port", "N", "port of --serve (default 8000; 0: any free one)",
          assign(to.port, [](const std::string& option, const std::string& text) {
              return text == "0" ? 0 : io::count_up_to(65535, option, text);
          }));
}

}  // namespace hilda::studies
