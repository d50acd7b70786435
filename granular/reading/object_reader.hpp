// SPDX-License-Identifier: GPL-3.0-or-later
/// Reader of one JSON object of a case: that of io, with vectors and formulas of granular.

#pragma once

#include "granular/reading/formula.hpp"
#include "io/object_reader.hpp"

namespace hilda::granular {

/// Numbers must be in the range of single precision, in which the particles are computed.
class ObjectReader : public io::ObjectReader {
public:
    ObjectReader(const io::JsonSource& source, const io::Json& value, std::string pointer)
        : ObjectReader(io::ObjectReader(source, value, std::move(pointer)))
    {}
    ObjectReader(io::ObjectReader o);

    Vec3 vec3(std::string_view key, const std::optional<Vec3>& fallback = {});
    Vec3 direction(std::string_view key);  ///< three numbers, not all zero, divided by their length
    std::array<bool, 3> flags(std::string_view key, const std::array<bool, 3>& fallback);
    /// Three or six values, each true or false. The last three are `others` if three are given.
    std::array<bool, 6> six_flags(std::string_view key, bool others);
    /// The sides of a box that the list names: -x, +x, -y, +y, -z, +z. Empty if the key is missing.
    std::array<bool, 6> sides(std::string_view key);
    static constexpr std::array<const char*, 6> side_names = {"-x", "+x", "-y", "+y", "-z", "+z"};
    /// Whether the value is a list that contains a string, that is, a formula
    bool has_formula(std::string_view key);
    /// A vector of three components, each a number or a formula in t
    VectorFormula formulas(std::string_view key);
    /// The path of a file, relative to the working directory. It must be below the folder of the case
    /// (Environment::folder), also after symbolic links have been followed.
    std::string file(std::string_view key);
    /// Readers of the elements of a list. Empty if the key is missing.
    std::vector<ObjectReader> objects(std::string_view key);
    ObjectReader object(std::string_view key) { return io::ObjectReader::object(key); }
    /// A reader of one element of a list
    ObjectReader object(std::string_view key, std::size_t element);
};

}  // namespace hilda::granular
