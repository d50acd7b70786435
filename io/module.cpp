// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/module.hpp"

#include "io/error.hpp"

#include <filesystem>
#include <vector>

#include <dlfcn.h>

namespace hilda::io {

std::string find_module(const ModuleFile& file)
{
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
    std::vector<fs::path> places = {folder, folder.parent_path(), folder.parent_path() / file.library_folder};
    Dl_info here{};
    if (dladdr(file.caller, &here) != 0 && here.dli_fname[0] == '/')
        places.push_back(fs::path(here.dli_fname).parent_path() / "hilda");
    for (const fs::path& place : places)
        if (fs::is_regular_file(place / file.name, error)) return place / file.name;
    return "";
}

void* module_symbol(const std::string& what, const ModuleFile& file, const char* symbol)
{
    const std::string path = find_module(file);
    if (path.empty()) return nullptr;
    void* const loaded = dlopen(path.c_str(), RTLD_NOW | (file.global ? RTLD_GLOBAL : RTLD_LOCAL));
    void* const found = loaded == nullptr ? nullptr : dlsym(loaded, symbol);
    if (found == nullptr) throw NotAvailable(what + ": " + dlerror());
    return found;
}

void refuse_without_module(const std::string& what, const std::string& module, const std::string& target,
                           const std::string& package)
{
    throw NotAvailable(what + ": needs the module " + module +
                       ", which was not built; after 'apt-get install " + package +
                       "' the commands 'cmake --preset release' and 'cmake --build build/release --target " +
                       target + "' in the source tree build it, and the Debian package hilda has it");
}

}  // namespace hilda::io
