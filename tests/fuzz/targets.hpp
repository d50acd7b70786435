// SPDX-License-Identifier: GPL-3.0-or-later
/// Entry functions of the fuzz targets. Each reads a text or a file of bytes as the programs do.
///
/// An input is accepted, or refused by one of the documented exceptions, which the entry function catches.
/// Any other exception ends the process: libFuzzer reports it, and the replay test fails.

#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace hilda::fuzz {

void expression(std::string_view input);     ///< the text of an expression
void model(std::string_view input);          ///< a model file
void granular_case(std::string_view input);  ///< a case file
void checkpoint(
    std::string_view input);  ///< the content of a checkpoint of hilda, without header and checksum
void granular_checkpoint(std::string_view input);  ///< the same of hilda-granular
void particles(std::string_view input);            ///< a table of particles (CSV)
void mesh(std::string_view input);                 ///< an OBJ text, and an STL file
void table(std::string_view input);                ///< a CSV table
void samples(std::string_view input);              ///< numbers t, f of a sampled motion
void words(std::string_view input);      ///< the command line in the record of a result, for hilda rerun
void xml(std::string_view input);        ///< a robot file, for the checks before a library reads it
void arguments(std::string_view input);  ///< a command line of hilda, one argument on each line
void granular_arguments(std::string_view input);  ///< a command line of hilda-granular

/// A checkpoint with this content: header and checksum are those of `valid`, a checkpoint of the program
std::string sealed(std::string_view content, const std::string& valid);
/// The content of a checkpoint
std::string_view content_of(const std::string& checkpoint);

/// Contents of valid checkpoints, the seeds of their corpora
std::string checkpoint_seed();
std::string granular_checkpoint_seed();

/// A command line for main(): the lines of a text, without NUL
class CommandLine {
public:
    CommandLine(const char* program, std::string_view lines);
    int argc() const { return static_cast<int>(pointers.size()) - 1; }
    char** argv() { return pointers.data(); }

private:
    std::vector<std::string> words;
    std::vector<char*> pointers;
};

}  // namespace hilda::fuzz
