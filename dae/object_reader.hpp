// SPDX-License-Identifier: GPL-3.0-or-later
/// Reader of one JSON object of a model: that of io, with vectors, matrices and orientations.

#pragma once

#include "io/object_reader.hpp"
#include "lie/so3.hpp"

namespace hilda::dae {

using io::About;
using io::described;
using io::Json;
using io::JsonSource;
using io::PlacedError;
using io::pointer_to;
using io::shortest;
using io::written;
using lie::Mat3;
using lie::Vec3;

class ObjectReader : public io::ObjectReader {
public:
    using io::ObjectReader::ObjectReader;
    ObjectReader(io::ObjectReader o) : io::ObjectReader(std::move(o)) {}

    Vec3 vec3(std::string_view key, const About& about = {}, const std::optional<Vec3>& fallback = {});
    Vec3 direction(std::string_view key, const About& about = {});  ///< three numbers, not all zero
    Mat3 matrix(std::string_view key, const About& about = {});     ///< by rows
    ObjectReader object(std::string_view key, const About& about = {}, std::string_view definition = {})
    {
        return io::ObjectReader::object(key, about, definition);
    }

private:
    Vec3 vector(std::string_view key);
};

/// Descriptions of the keys of an orientation
struct AboutOrientation {
    About A, p, axis_angle, euler_angles;
};

/// Notes the keys of an orientation for the schema.
void note_orientation(ObjectReader& o, const AboutOrientation& about);

/// Orientation given by one of the keys A, p, axis_angle and euler_angles, or the identity. Deviations from a
/// rotation of up to 1e-6 are corrected. Throws PlacedError for larger ones.
Mat3 read_orientation(ObjectReader& o, const AboutOrientation& about);

/// A vector or matrix as a JSON list; a matrix by rows
Json json(const Vec3& v);
Json json(const Mat3& m);

}  // namespace hilda::dae
