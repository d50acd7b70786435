// SPDX-License-Identifier: GPL-3.0-or-later
/// Modules: shared objects of the project that a program loads when it needs them, so that it starts without
/// their libraries.

#pragma once

#include <string>

namespace hilda::io {

struct ModuleFile {
    std::string name;            ///< "hilda-mpi.so"
    std::string library_folder;  ///< of the installation, relative to that of the program: "lib/hilda"
    const void* caller;          ///< a function of the library that loads the module
    bool global = false;         ///< whether libraries that are loaded later use the symbols of its libraries
};

/// Path of a module; empty if there is no such file. It is searched beside the program (in the build folder,
/// also of the tests), in lib/hilda of the installation, and in hilda/ beside the library of the caller.
std::string find_module(const ModuleFile& file);

/// Loads a module and returns a symbol of it; nullptr if there is no such file. Throws NotAvailable
/// "WHAT: ..." if it cannot be loaded.
void* module_symbol(const std::string& what, const ModuleFile& file, const char* symbol);

/// Throws NotAvailable "WHAT: needs the module ..." with the way to build it: the target of CMake, and the
/// Debian package that it needs.
[[noreturn]] void refuse_without_module(const std::string& what, const std::string& module,
                                        const std::string& target, const std::string& package);

}  // namespace hilda::io
