// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/object_reader.hpp"

#include "lie/euler_parameters.hpp"
#include "lie/euler_sequence.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hilda::dae {

namespace {

// Largest deviation from a rotation that is corrected. It admits orientations with seven digits.
constexpr double orientation_tolerance = 1e-6;
// An A with a smaller error is not changed, so that writing and reading a model leaves it unchanged.
constexpr double exact_rotation = 1e-14;

const std::vector<std::string> forms = {"A", "p", "axis_angle", "euler_angles"};

}  // namespace

Vec3 ObjectReader::vec3(std::string_view key, const About& about, const std::optional<Vec3>& fallback)
{
    if (records_schema()) {
        const Json by_default = fallback ? json(*fallback) : Json();
        note(key, "vector", about, fallback ? &by_default : nullptr);
    }
    if (lookup(key, !fallback) == nullptr) {
        record(key, json(*fallback));
        return *fallback;
    }
    return vector(key);
}

Vec3 ObjectReader::vector(std::string_view key)
{
    const std::vector<double> x = numbers(key, 3);
    return {x[0], x[1], x[2]};
}

Vec3 ObjectReader::direction(std::string_view key, const About& about)
{
    note(key, "direction", about);
    Vec3 v = vector(key);
    const double length = v.norm();
    if (!(length > 0) || !std::isfinite(length))
        fail(key, std::string(key) + " must have a direction, got " + described(*find(key)) + " of length " +
                      shortest(length));
    return v;
}

Mat3 ObjectReader::matrix(std::string_view key, const About& about)
{
    note(key, "matrix", about);
    const Json& v = *lookup(key, true);
    Mat3 m;
    const auto is_row = [](const Json& row) { return row.list() != nullptr && row.list()->size() == 3; };
    if (v.list() == nullptr || v.list()->size() != 3 ||
        !std::all_of(v.list()->begin(), v.list()->end(), is_row))
        fail(key, std::string(key) + " must be three rows of three numbers, got " + described(v));
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            m(i, j) =
                number_at((*(*v.list())[i].list())[j],
                          pointer_to(pointer_to(pointer(key), std::to_string(i)), std::to_string(j)), key);
    record(key, json(m));
    return m;
}

void note_orientation(ObjectReader& o, const AboutOrientation& about)
{
    constexpr const char* four =
        R"("type": "array", "items": {"type": "number"}, "minItems": 4, "maxItems": 4)";
    o.note("A", "matrix", about.A);
    o.note("p", four, about.p);
    o.note("axis_angle", four, about.axis_angle);
    o.note("euler_angles", R"("$ref": "#/$defs/euler_angles")", about.euler_angles);
    o.note_exclusive(forms);
}

Mat3 read_orientation(ObjectReader& o, const AboutOrientation& about)
{
    note_orientation(o, about);
    const auto given = std::count_if(forms.begin(), forms.end(),
                                     [&](const std::string& key) { return o.find(key) != nullptr; });
    if (given > 1)
        o.fail("the orientation must be given once, as one of A, p, axis_angle and euler_angles; got " +
               std::to_string(given));

    const auto deviation_message = [](const std::string& what, double value) {
        return what + ", got " + shortest(value) + "; deviations up to " + shortest(orientation_tolerance) +
               " are corrected";
    };
    Mat3 A = Mat3::Identity();
    if (o.has("A")) {
        A = o.matrix("A");
        if (const double error = lie::orthogonality_error(A); !(error <= orientation_tolerance))
            o.fail("A", deviation_message("A must be a rotation matrix: |A^T A - I| must be 0", error));
        if (!(A.determinant() > 0)) o.fail("A", "A must be a rotation matrix, got a reflection (det A = -1)");
        if (!(lie::orthogonality_error(A) <= exact_rotation)) A = lie::nearest_rotation(A);
    } else if (o.has("p")) {
        const std::vector<double> e = o.numbers("p", 4);
        const lie::Vec4 p(e[0], e[1], e[2], e[3]);
        if (!(std::abs(p.norm() - 1) <= orientation_tolerance))
            o.fail("p", deviation_message("p must have length 1", p.norm()));
        A = lie::rotation(p.normalized());
    } else if (o.has("axis_angle")) {
        const std::vector<double> a = o.numbers("axis_angle", 4);
        const Vec3 u(a[0], a[1], a[2]);
        if (!(std::abs(u.norm() - 1) <= orientation_tolerance))
            o.fail("axis_angle", deviation_message("the axis of axis_angle must have length 1", u.norm()));
        A = lie::exp(std::remainder(a[3], 2 * std::numbers::pi) * u.normalized());
    } else if (o.has("euler_angles")) {
        ObjectReader e = o.object("euler_angles", about.euler_angles, "euler_angles");
        e.defines(
            "euler_angles", "Euler angles",
            "Three rotations about the axes of the frame as it turns: A = R(angle 1) R(angle 2) R(angle "
            "3), each about the axis of the sequence.");
        const std::string name = e.text(
            "sequence",
            {"Axes of the three rotations, in this order: zxz is that of Fang (2022), Eq. 2.1b, with the "
             "angles theta, phi, psi; zyx is yaw, pitch and roll.",
             R"("zxz")",
             R"("enum": ["xyx", "xyz", "xzx", "xzy", "yxy", "yxz", "yzx", "yzy", "zxy", "zxz", "zyx", "zyz"])"});
        const auto sequence = lie::EulerSequence::named(name);
        if (!sequence)
            e.fail("sequence",
                   "a sequence must be three of the letters x, y and z in which neighbours differ, such as "
                   "zxz, got " +
                       described(name));
        Vec3 angles =
            Vec3::Map(e.numbers("angles", 3, {"The three angles [rad].", R"([0.5, "pi/4", 0])"}).data());
        for (double& angle : angles) angle = std::remainder(angle, 2 * std::numbers::pi);
        A = sequence->rotation(angles);
        e.finish();
    }
    return A;
}

// The elements of a braced list are copied. A model has many of these lists.
Json json(const Vec3& v)
{
    Json::List list(3);
    for (size_t k = 0; k < 3; ++k) list[k].value = v[static_cast<Eigen::Index>(k)];
    return list;
}

Json json(const Mat3& m)
{
    Json::List rows(3);
    for (size_t k = 0; k < 3; ++k) rows[k] = json(Vec3(m.row(static_cast<Eigen::Index>(k))));
    return rows;
}

}  // namespace hilda::dae
