// SPDX-License-Identifier: GPL-3.0-or-later
/// Exceptions of all rooms, and the exit codes of the programs.

#pragma once

#include <sstream>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

namespace hilda::io {

namespace exit_code {
inline constexpr int done = 0;
inline constexpr int internal_error = 1;
inline constexpr int wrong_command_line = 2;
inline constexpr int invalid_input = 3;      ///< InvalidInput
inline constexpr int numerical_failure = 4;  ///< NumericalFailure
inline constexpr int input_output = 5;
inline constexpr int expectation_failed = 6;
inline constexpr int not_available = 7;
inline constexpr int signal = 128;  ///< plus the number of the signal
}  // namespace exit_code

/// Invalid input. what() contains the place, the error and the value.
class InvalidInput : public std::invalid_argument {
public:
    using std::invalid_argument::invalid_argument;
};

/// The shortest decimal text that is read as the same number
std::string shortest(double x);

/// Throws InvalidInput "where: what, got value".
template <class Value>
[[noreturn]] void reject(const std::string& where, const std::string& what, const Value& value)
{
    std::ostringstream text;
    text.precision(17);
    text << where << ": " << what << ", got ";
    if constexpr (std::is_floating_point_v<Value>)
        text << shortest(value);
    else
        text << value;
    throw InvalidInput(text.str());
}

/// A computation that failed. If a step of an integrator throws it, the state remains that of t_n.
class NumericalFailure : public std::runtime_error {
public:
    NumericalFailure(std::string status, const std::string& what)
        : std::runtime_error(what), status(std::move(status))
    {}

    /// newton_diverged, singular_matrix, nonfinite, constraint_drift, singular_parametrisation, ida_failed,
    /// ...
    std::string status;
};

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

}  // namespace hilda::io
