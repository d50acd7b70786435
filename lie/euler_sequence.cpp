// SPDX-License-Identifier: GPL-3.0-or-later
#include "lie/euler_sequence.hpp"

#include <cmath>

namespace hilda::lie {

std::optional<EulerSequence> EulerSequence::named(std::string_view name)
{
    EulerSequence s{};
    if (name.size() != 3) return std::nullopt;
    for (std::size_t k = 0; k < 3; ++k) {
        if (name[k] < 'x' || name[k] > 'z' || (k > 0 && name[k] == name[k - 1])) return std::nullopt;
        s.axis[k] = name[k] - 'x';
    }
    return s;
}

Mat3 EulerSequence::rotation(const Vec3& angles) const
{
    Mat3 A = Mat3::Identity();
    for (int k = 0; k < 3; ++k)
        A = A *
            Eigen::AngleAxisd(angles[k], Vec3::Unit(axis[static_cast<std::size_t>(k)])).toRotationMatrix();
    return A;
}

Vec3 EulerSequence::angles(const Mat3& A) const
{
    const int i = axis[0], j = axis[1],
              l = 3 - i - j;  // l: the axis that is neither the first nor the second
    const double sign = (j - i + 3) % 3 == 1 ? 1 : -1;  // of the permutation (i, j, l)
    const double across = std::hypot(A(i, j), is_proper() ? A(i, l) : A(i, i));
    const double second = is_proper() ? std::atan2(across, A(i, i)) : std::atan2(sign * A(i, l), across);
    constexpr double rounding = 1e-14;  // of the elements of A
    if (across <= rounding) return {std::atan2(sign * A(l, j), A(j, j)), second, 0};
    if (is_proper())
        return {std::atan2(A(j, i), -sign * A(l, i)), second, std::atan2(A(i, j), sign * A(i, l))};
    return {std::atan2(-sign * A(j, l), A(l, l)), second, std::atan2(-sign * A(i, j), A(i, i))};
}

}  // namespace hilda::lie
