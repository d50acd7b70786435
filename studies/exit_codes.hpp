// SPDX-License-Identifier: GPL-3.0-or-later
/// Exit codes of the program, and the exceptions that cause them.

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

/// An error outside the numerics and the model, with its exit code
class Failure : public std::runtime_error {
public:
    Failure(int code, const std::string& what) : std::runtime_error(what), code(code) {}

    int code;
};

/// An invalid command line
class UsageError : public Failure {
public:
    explicit UsageError(const std::string& what) : Failure(exit_code::wrong_command_line, what) {}
};

/// A file cannot be read or written. what() begins with its path.
class IoError : public Failure {
public:
    explicit IoError(const std::string& what) : Failure(exit_code::input_output, what) {}
};

/// A device or an optional component is not available.
class NotAvailable : public Failure {
public:
    explicit NotAvailable(const std::string& what) : Failure(exit_code::not_available, what) {}
};

/// Prints the error on stderr as "hilda: error: ..." and returns its exit code. All commands report their
/// errors here.
int report(const std::exception& error);

}  // namespace hilda::studies
