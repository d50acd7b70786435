// SPDX-License-Identifier: GPL-3.0-or-later
/// Reader of one JSON object of a case: that of io, with vectors and formulas of granular.

#pragma once

#include "granular/reading/formula.hpp"
#include "io/object_reader.hpp"

namespace hilda::granular {

/// Numbers must be in the range of single precision, in which the particles are computed. The calls are also
/// the schema of cases, see io::ObjectReader.
class ObjectReader : public io::ObjectReader {
public:
    ObjectReader(const io::JsonSource& source, const io::Json& value, std::string pointer)
        : ObjectReader(io::ObjectReader(source, value, std::move(pointer)))
    {}
    ObjectReader(io::ObjectReader o);

    Vec3 vec3(std::string_view key, const io::About& about = {}, const std::optional<Vec3>& fallback = {});
    /// Three numbers, not all zero, divided by their length
    Vec3 direction(std::string_view key, const io::About& about);
    /// A positive number, or nothing if the key is missing
    std::optional<double> optional_positive(std::string_view key, const io::About& about);
    std::array<bool, 3> flags(std::string_view key, const io::About& about,
                              const std::array<bool, 3>& fallback);
    /// Three or six values, each true or false. The last three are `others` if three are given.
    std::array<bool, 6> six_flags(std::string_view key, const io::About& about, bool others);
    /// The sides of a box that the list names: -x, +x, -y, +y, -z, +z. Empty if the key is missing.
    std::array<bool, 6> sides(std::string_view key, const io::About& about);
    static constexpr std::array<const char*, 6> side_names = {"-x", "+x", "-y", "+y", "-z", "+z"};
    /// Whether the value is a list that contains a string, that is, a formula
    bool has_formula(std::string_view key);
    /// A vector of three components, each a number or a formula in t
    VectorFormula formulas(std::string_view key);
    /// The path of a file, relative to the folder of the case (JsonSource::base). It must be below this
    /// folder (Environment::folder), also after symbolic links have been followed.
    std::string file(std::string_view key, const io::About& about);
    /// Readers of the elements of a list, which have the definition `of` in the schema. Empty if the key is
    /// missing: the caller refuses this if the list is required.
    std::vector<ObjectReader> objects(std::string_view key, std::string_view of = {},
                                      const io::About& about = {}, bool required = false);
    ObjectReader object(std::string_view key, const io::About& about, std::string_view definition = {})
    {
        return io::ObjectReader::object(key, about, definition);
    }
    /// A reader of one element of a list
    ObjectReader object(std::string_view key, std::size_t element);
};

}  // namespace hilda::granular
