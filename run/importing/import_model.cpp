// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/importing/import_model.hpp"

#include "dae/model_file.hpp"
#include "io/error.hpp"
#include "io/files.hpp"
#include "io/message.hpp"
#include "io/module.hpp"
#include "run/importing/xml_scan.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <iostream>
#include <string_view>

namespace hilda::run {

namespace fs = std::filesystem;

namespace {

struct Format {
    const char *root, *name, *module, *symbol, *target, *package;
};
constexpr Format formats[] = {
    {"robot", "URDF", "hilda-urdf.so", "hilda_import_urdf", "hilda_urdf", "liburdfdom-dev"},
    {"mujoco", "MJCF", "hilda-mjcf.so", "hilda_import_mjcf", "hilda_mjcf", "libmujoco-dev"}};

/// Name of the first element of an XML text; empty if there is none
std::string_view root_element(std::string_view text)
{
    for (size_t at = 0; (at = text.find('<', at)) != std::string_view::npos;) {
        if (text.substr(at).starts_with("<!--")) {
            at = text.find("-->", at);
        } else if (text[at + 1] != '?' && text[at + 1] != '!') {
            text.remove_prefix(at + 1);
            return text.substr(0, text.find_first_of(" \t\r\n/>"));
        } else {
            ++at;
        }
        if (at == std::string_view::npos) break;
    }
    return {};
}

const Format& format_of(const std::string& file)
{
    const std::string text = io::read_file(file, size_t(64) << 20);
    const std::string_view root = root_element(text);
    for (const Format& format : formats)
        if (root == format.root) return format;
    throw io::InvalidInput(fmt::format(
        "{}: has the root element '{}'; expected robot (URDF) or mujoco (MJCF)", file, root.substr(0, 40)));
}

/// The model, whose messages name the bodies and joints of the file
std::pair<dae::Description, dae::StartReport> started(const std::string& text, const std::string& file)
{
    try {
        dae::Description description = dae::read_model(text, "imported model");
        dae::StartReport start = dae::start(description);
        return {std::move(description), std::move(start)};
    } catch (const io::InvalidInput& error) {
        const std::string message = message_about(text, error.what());
        throw io::InvalidInput(file + ": " + message +
                               (message.find("no principal moment of inertia may exceed") == message.npos
                                    ? ""
                                    : "; --balance-inertia replaces the moments by their mean"));
    }
}

}  // namespace

int import_model(const ImportOptions& options)
{
    const Format& format = format_of(options.file);
    check_robot_file(options.file);
    void* const symbol = io::module_symbol("import",
                                           {.name = format.module,
                                            .library_folder = HILDA_LIBRARY_FOLDER,
                                            .caller = reinterpret_cast<const void*>(&import_model)},
                                           format.symbol);
    if (symbol == nullptr)
        io::refuse_without_module(std::string("import of ") + format.name, format.module, format.target,
                                  format.package);
    ImportedModel model;
    model.imports_contacts = options.contacts;
    reinterpret_cast<void (*)(const std::string&, bool, ImportedModel&)>(symbol)(options.file,
                                                                                 options.free_base, model);
    const std::string output =
        options.output.empty() ? fs::path(options.file).stem().string() + ".json" : options.output;
    model.balances_inertia = options.balances_inertia;
    const std::string text = model_text(model, options.file);
    const auto [description, start] = started(text, options.file);
    std::error_code error;
    if (fs::exists(output, error) && !options.force)
        throw io::InvalidInput(output + ": the file exists; --force replaces it");
    io::write_named_file(output, text);
    for (const std::string& warning : model.warnings)
        io::warning(options.file + ": not imported: " + warning);
    std::cout << fmt::format(
        "written       {}: {} with {} of freedom{}\n", output,
        io::counted(static_cast<long>(description.model->all_bodies().size()), "body", "bodies"),
        io::counted(start.degrees_of_freedom, "degree", "degrees"),
        options.contacts ? ", " + io::counted(model.contact_pairs, "rigid contact", "rigid contacts") : "");
    return io::exit_code::done;
}

}  // namespace hilda::run
