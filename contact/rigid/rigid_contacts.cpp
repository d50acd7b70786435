// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact/rigid/rigid_contacts.hpp"

#include "contact/detection/near_pairs.hpp"
#include "contact/tangent_basis.hpp"
#include "dae/model.hpp"
#include "io/json.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hilda::contact {

namespace {

constexpr double largest_start_overlap = 1e-6;  // relative to the smaller size
constexpr double reach_of_output = 1e-2;        // the same
constexpr double least_reach = 1e-6;            // the same: bodies that touch at rest

/// The speed at which a point of a body can move: |ṙ| + R |ω̄|; R is infinite for unbounded surfaces
double largest_speed(const Motion& body, double R)
{
    const double turn = body.omega_bar.norm();
    return body.rdot.norm() + (turn > 0 ? turn * R : 0);
}

/// axesᵀ (ṙ + ω × s) = C (ṙ, ω̄)
lie::ConeRows::Mat36 rows_of(const Motion& body, const Vec3& s, const Mat3& axes)
{
    lie::ConeRows::Mat36 C;
    C.leftCols<3>() = axes.transpose();
    for (int k = 0; k < 3; ++k) C.block<1, 3>(k, 3) = (body.A.transpose() * s.cross(axes.col(k))).transpose();
    return C;
}

/// Two tangents; those of -n are their negatives, so that exchanged bodies have the same rows C_i and C_j
Eigen::Matrix<double, 3, 2> tangents(const Vec3& n)
{
    Eigen::Index largest = 0;
    n.cwiseAbs().maxCoeff(&largest);
    if (n[largest] < 0) return -tangent_basis(-n);
    return tangent_basis(n);
}

/// The feature of a contact point whose order of the bodies is that of their numbers: exchanged bodies have
/// the same keys in the same order.
std::uint32_t ordered(std::uint32_t feature, int i, int j)
{
    return i > j ? feature << 16 | feature >> 16 : feature;
}

}  // namespace

void RigidLaw::validate() const
{
    constexpr const char* where = "contact::RigidLaw";
    if (!(mu_k >= 0) || !std::isfinite(mu_k)) lie::reject(where, "mu_k must not be negative", mu_k);
    if (!(mu_s >= mu_k) || !std::isfinite(mu_s)) lie::reject(where, "mu_s must not be below mu_k", mu_s);
    if (!(restitution >= 0 && restitution <= 1))
        lie::reject(where, "the coefficient of restitution must be in [0, 1]", restitution);
}

RigidContacts::RigidContacts(std::string name, const dae::Model& model, ContactPairs pairs, Shape i, Shape j,
                             const RigidLaw& law)
    : name(std::move(name)), shape_i(std::move(i)), shape_j(std::move(j)), law(law), model(model),
      of(std::move(pairs)), detector(make_detector(shape_i, shape_j)), size(smaller_size(shape_i, shape_j)),
      reach_i(reach_about_centre(shape_i)), reach_j(reach_about_centre(shape_j))
{
    law.validate();
    for (const auto* list : {&of.first, &of.second})
        for (const int b : *list)
            if (b < dae::ground || b >= model.bodies())
                lie::reject("contact '" + this->name + "'", "no body has this number", b);
    if (!std::isfinite(size)) size = 1;
}

std::string RigidContacts::name_of_pair(int number) const
{
    if (!of.is_group) return name;
    const auto [i, j] = of.pair(number);
    return ContactPairs::name_of_pair(model, name, i, j);
}

/// The result of `find`, or its failure with the names of the contact and its bodies
template <class Find>
auto RigidContacts::named(const lie::State& x, int i, int j, const Find& find) const
{
    try {
        return find(dae::motion(x, i), dae::motion(x, j));
    } catch (const lie::NumericalFailure& e) {
        throw lie::NumericalFailure(e.status, "contact '" + name + "': " + e.what() + "; bodies '" +
                                                  model.body_name(i) + "', '" + model.body_name(j) +
                                                  "', t = " + io::shortest(x.t) + " s");
    }
}

void RigidContacts::detect(const lie::State& x, int i, int j, double reach, Manifold& out) const
{
    named(x, i, j, [&](const Motion& bi, const Motion& bj) { detector->detect_all(bi, bj, reach, out); });
}

ContactPoint RigidContacts::nearest(const lie::State& x, int number) const
{
    const auto [i, j] = of.pair(number);
    Manifold all;
    detect(x, i, j, std::numeric_limits<double>::infinity(), all);
    return std::min_element(
               all.begin(), all.end(),
               [](const ManifoldPoint& p, const ManifoldPoint& q) { return p.at.gap < q.at.gap; })
        ->at;
}

/// The pairs that may touch in a step h
void RigidContacts::find_pairs(const lie::State& x, double h, std::vector<int>& numbers) const
{
    if (of.numbers() == 1) {
        numbers.assign(1, 0);
        return;
    }
    static thread_local std::vector<double> motion;
    motion.resize(x.body.size());
    for (std::size_t b = 0; b < x.body.size(); ++b) {
        const double R = std::max(std::isfinite(reach_i) ? reach_i : 0, std::isfinite(reach_j) ? reach_j : 0);
        const double acceleration = model.gravity.norm() + x.body[b].rddot.norm();
        motion[b] = h * (largest_speed(x.body[b], R) + h * acceleration) + least_reach * size;
    }
    find_near_pairs(of, shape_i, shape_j, x.body, motion, numbers);
}

void RigidContacts::add_cones(const lie::State& x, double h, lie::ConeRows& out) const
{
    static thread_local std::vector<int> numbers;
    find_pairs(x, h, numbers);
    Manifold manifold;
    for (const int number : numbers) {
        const auto [i, j] = of.pair(number);
        const Motion &bi = dae::motion(x, i), &bj = dae::motion(x, j);
        // loads beside gravity are bounded by the accelerations of the last step
        const double acceleration = model.gravity.norm() + (bi.rddot.norm() + bj.rddot.norm());
        const double reach =
            h * (largest_speed(bi, reach_i) + largest_speed(bj, reach_j) + h * acceleration) +
            least_reach * size;
        detect(x, i, j, reach, manifold);
        const auto before = static_cast<std::ptrdiff_t>(out.cone.size());
        for (const ManifoldPoint& p : manifold) {
            lie::ConeRows::Cone& cone = out.cone.emplace_back();
            cone.key = static_cast<std::uint64_t>(first_pair + number) << 32 | ordered(p.feature, i, j);
            cone.i = i, cone.j = j;
            cone.axes << p.at.n, tangents(p.at.n);
            const Vec3 C = p.at.C();
            if (i != dae::ground) cone.C_i = rows_of(bi, C - bi.r, cone.axes);
            if (j != dae::ground) cone.C_j = -rows_of(bj, C - bj.r, cone.axes);
            cone.gap = p.at.gap;
            cone.mu_s = law.mu_s, cone.mu_k = law.mu_k, cone.restitution = law.restitution;
            cone.size = size;
        }
        std::sort(out.cone.begin() + before, out.cone.end(),
                  [](const auto& c, const auto& d) { return c.key < d.key; });
    }
}

std::string RigidContacts::start_error(const lie::State& x) const
{
    std::vector<int> numbers;
    find_pairs(x, 0, numbers);
    Manifold manifold;
    for (const int number : numbers) {
        const auto [i, j] = of.pair(number);
        detect(x, i, j, 0, manifold);
        for (const ManifoldPoint& p : manifold)
            if (-p.at.gap > largest_start_overlap * size)
                return "contact '" + name_of_pair(number) +
                       "': the surfaces of rigid bodies must not overlap by more than " +
                       io::shortest(largest_start_overlap * size) + " m at the start, got " +
                       io::shortest(-p.at.gap) + " m";
    }
    return {};
}

dae::RigidContacts::Fastest RigidContacts::fastest(const lie::State& x) const
{
    Fastest of_all;
    if (!std::isfinite(reach_i) || !std::isfinite(reach_j)) return of_all;
    for (const auto* list : {&of.first, &of.second})
        for (const int b : *list)
            if (const double ratio = dae::motion(x, b).rdot.norm() / (2 * size);
                ratio > of_all.widths_per_second)
                of_all = {ratio, b};
    return of_all;
}

void RigidContacts::points(const lie::State& x, int number, std::vector<LoadedPoint>& out) const
{
    out.clear();
    const auto [i, j] = of.pair(number);
    Manifold manifold;
    detect(x, i, j, reach_of_output * size, manifold);
    const std::uint64_t first_key = static_cast<std::uint64_t>(first_pair + number) << 32;
    for (const ManifoldPoint& p : manifold) {
        const std::uint64_t key = first_key | ordered(p.feature, i, j);
        const auto force =
            std::lower_bound(x.cone_forces.begin(), x.cone_forces.end(), key,
                             [](const lie::ConeForce& f, std::uint64_t k) { return f.key < k; });
        LoadedPoint& point = out.emplace_back();
        point.at = p.at, point.feature = p.feature;
        if (force == x.cone_forces.end() || force->key != key) continue;
        point.N = force->F.dot(p.at.n);
        point.F = force->F - point.N * p.at.n;
        point.slips = force->slips > 0;
    }
}

}  // namespace hilda::contact
