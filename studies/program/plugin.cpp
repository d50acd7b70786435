// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/program/plugin.hpp"

#include "contact/friction/friction.hpp"
#include "contact/normal/normal_law.hpp"
#include "contact/surface_types.hpp"
#include "dae/model_schema.hpp"
#include "dae/model_types.hpp"
#include "dae/outputs/output.hpp"
#include "io/archive.hpp"
#include "io/error.hpp"
#include "io/files.hpp"
#include "io/message.hpp"
#include "io/registry.hpp"
#include "lie/schemes.hpp"
#include "run/plugin_interface.hpp"
#include "run/tables/sink.hpp"
#include "studies/framework/problem.hpp"
#include "studies/framework/study.hpp"
#include "studies/program/plot.hpp"

#include <fmt/format.h>

#include <dlfcn.h>
#include <unistd.h>

#include <exception>
#include <filesystem>
#include <thread>

namespace hilda::studies {

namespace {

constexpr size_t most = size_t{1} << 30;  // largest plug-in [byte]

std::string loading;  // absolute path of the plug-in, for report_and_exit()

template <class... Entry>
size_t entries()
{
    return (io::Registry<Entry>::all().size() + ...);
}
/// Number of the entries that a plug-in can add
size_t registered_entries()
{
    return entries<lie::Scheme, dae::ConstraintType, dae::ForceType, dae::OutputType, dae::SchemaPart,
                   contact::SurfaceType, contact::NormalLawType, contact::FrictionLaw, Problem,
                   run::SinkType>() +
           studies().size();
}

std::string bytes_of(const std::string& file)
{
    try {
        return io::read_file(file, most);
    } catch (const io::IoError& error) {
        throw io::NotAvailable(std::string("--load: ") + error.what());
    }
}

/// The interface in the bytes of a plug-in, read before its code runs; "" without one
std::string interface_of(const std::string& bytes)
{
    const std::string marker = HILDA_PLUGIN_MARKER;
    const size_t at = bytes.find(marker);
    return at == std::string::npos ? "" : std::string(bytes.c_str() + at + marker.size());
}

/// The terminate handler during open(): reports an exception of a static initialiser.
[[noreturn]] void report_and_exit()
{
    try {
        if (const std::exception_ptr thrown = std::current_exception()) std::rethrow_exception(thrown);
    } catch (const std::exception& error) {
        io::report(io::NotAvailable("--load " + loading + ": throws while it is loaded: " + error.what()));
    } catch (...) {
        io::report(io::NotAvailable("--load " + loading + ": throws while it is loaded"));
    }
    _exit(io::exit_code::not_available);
}

/// dlopen() in a thread of its own, with the reason of a failure. An exception of a static initialiser finds
/// no handler there and calls the terminate handler. In the thread of main() it would be caught, but the
/// frames of dlopen() cannot be unwound.
void open(const std::string& file, std::string& failure)
{
    std::thread([&] {
        if (dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL) == nullptr) failure = dlerror();
    }).join();
}

}  // namespace

std::string load_plugin(const std::string& file)
{
    const std::string bytes = bytes_of(file);
    const std::string interface = interface_of(bytes);
    const std::string where = "--load " + file + ": ";
    if (interface.empty())
        throw io::NotAvailable(
            where + "is not a plug-in of hilda; hilda_add_plugin() of its CMake package builds one");
    if (interface != HILDA_PLUGIN_INTERFACE)
        throw io::NotAvailable(where + "is built for hilda " + interface + "; this program is hilda " +
                               HILDA_PLUGIN_INTERFACE +
                               ". Build the plug-in with the package of this program");
    loading = std::filesystem::absolute(file).string();
    if (dlopen(loading.c_str(), RTLD_NOW | RTLD_NOLOAD) != nullptr)
        throw io::NotAvailable(where + "is loaded already");
    const size_t before = registered_entries();
    const std::terminate_handler handler = std::set_terminate(report_and_exit);
    std::string failure;
    open(loading, failure);
    std::set_terminate(handler);
    if (!failure.empty()) throw io::NotAvailable(where + "cannot be loaded: " + failure);
    if (registered_entries() == before)
        throw io::NotAvailable(where + "registers nothing; see docs/extending/plugin.md");
    add_script_directory(std::filesystem::path(loading).parent_path().string());
    std::error_code error;
    return fmt::format("{} ({:016x})", std::filesystem::weakly_canonical(loading, error).string(),
                       io::checksum(bytes.data(), bytes.size()));
}

std::vector<std::string> load_plugins(const std::vector<char*>& given, std::vector<char*>& words)
{
    std::vector<std::string> plugins;
    size_t k = 0;
    if (k < given.size()) words.push_back(given[k++]);
    for (; k < given.size() && std::string_view(given[k]).starts_with("--load"); ++k) {
        const std::string_view word = given[k];
        if (word != "--load" && !word.starts_with("--load=")) break;
        if (word == "--load" && ++k == given.size()) throw io::UsageError("--load: needs a FILE");
        plugins.push_back(load_plugin(word == "--load" ? given[k] : std::string(word.substr(7))));
    }
    words.insert(words.end(), given.begin() + static_cast<std::ptrdiff_t>(k), given.end());
    return plugins;
}

}  // namespace hilda::studies
