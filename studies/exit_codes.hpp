// SPDX-License-Identifier: GPL-3.0-or-later
/// How the program ends: what the exit codes mean, and the exceptions that lead to them.

#pragma once

#include <exception>
#include <stdexcept>
#include <string>

namespace hilda::studies {

namespace exit_code {
inline constexpr int done = 0;
inline constexpr int internal_error = 1;
inline constexpr int wrong_command_line = 2;
inline constexpr int invalid_input = 3;      ///< lie::InvalidInput
inline constexpr int numerical_failure = 4;  ///< lie::NumericalFailure
inline constexpr int input_output = 5;
inline constexpr int expectation_failed = 6;
inline constexpr int not_available = 7;
inline constexpr int signal = 128;  ///< plus the number of the signal
}  // namespace exit_code

/// An error of the program's own surroundings, with the exit code it leads to.
class Failure : public std::runtime_error {
public:
    Failure(int code, const std::string& what) : std::runtime_error(what), code(code) {}

    int code;
};

/// The command line asks for something that cannot be.
class UsageError : public Failure {
public:
    explicit UsageError(const std::string& what) : Failure(exit_code::wrong_command_line, what) {}
};

/// A file could not be read or written. what() names it.
class IoError : public Failure {
public:
    explicit IoError(const std::string& what) : Failure(exit_code::input_output, what) {}
};

/// A device or an optional part is not there.
class NotAvailable : public Failure {
public:
    explicit NotAvailable(const std::string& what) : Failure(exit_code::not_available, what) {}
};

/// Says on stderr what happened, "hilda: error: ...", and returns the exit code. The one place where this is
/// decided.
int report(const std::exception& error);

}  // namespace hilda::studies
