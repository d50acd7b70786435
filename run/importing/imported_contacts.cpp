// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/importing/imported_contacts.hpp"

#include "contact/detection/detector.hpp"
#include "dae/object_reader.hpp"
#include "io/error.hpp"
#include "io/message.hpp"
#include "lie/check.hpp"
#include "run/importing/imported_surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace hilda::run {

namespace {

using lie::Mat3;
using lie::Vec3;

constexpr std::size_t most_entries = 10000;
/// Overlap at the start that rigid contacts accept, relative to the smaller size
constexpr double accepted_overlap = 1e-6;

/// Values below the rounding error of the pose become zero.
Vec3 without_noise(const Vec3& v, double size)
{
    return v.unaryExpr([&](double x) { return std::abs(x) <= 1e-14 * size ? 0. : x; });
}

/// A shape in the frame of the body that owns it
struct OwnedShape {
    const ImportedShape* of;
    int owner;
    contact::Shape shape;
    io::Json keys;
};

/// Whether the shapes are equal in the frames of their bodies
bool are_alike(const OwnedShape& a, const OwnedShape& b)
{
    constexpr double tolerance = 1e-12;
    const auto near = [&](const auto& x, const auto& y, double scale) {
        return (x - y).norm() <= tolerance * scale;
    };
    const double size = a.of->size.norm() + a.shape.position.norm();
    return a.of->type == b.of->type && a.of->mu == b.of->mu &&
           a.of->is_frictionless == b.of->is_frictionless && a.of->priority == b.of->priority &&
           near(a.of->size, b.of->size, size) && near(a.shape.position, b.shape.position, size) &&
           near(a.shape.orientation, b.shape.orientation, 1) && a.of->points == b.of->points;
}

/// Coefficient of friction of two geoms by the rules of MuJoCo: that of the higher priority, otherwise the
/// larger one, and none if both are frictionless
double friction(const ImportedShape& a, const ImportedShape& b)
{
    if (a.priority != b.priority) {
        const ImportedShape& first = a.priority > b.priority ? a : b;
        return first.is_frictionless ? 0 : first.mu;
    }
    return a.is_frictionless && b.is_frictionless ? 0 : std::max(a.mu, b.mu);
}

class ContactWriter {
public:
    ContactWriter(ImportedModel& model, const std::vector<ImportedBody>& bodies,
                  const std::vector<int>& owners, const std::string& file)
        : model(model), bodies(bodies), owners(owners), file(file)
    {}

    io::Json contacts()
    {
        for (const ImportedShape& shape : model.shapes) add(shape);
        for (std::size_t a = 0; a < kinds.size(); ++a)
            for (std::size_t b = a; b < kinds.size(); ++b) add_pairs_of(kinds[a], kinds[b], a == b);
        return std::move(all);
    }

private:
    using Kind = std::vector<OwnedShape>;  ///< shapes that are alike, of different bodies or of the ground

    int owner(int n) const { return n < 0 ? -1 : owners[static_cast<std::size_t>(n)]; }
    const std::string& name_of(int n) const
    {
        static const std::string ground = "ground";
        return n < 0 ? ground : bodies[static_cast<std::size_t>(n)].name;
    }
    lie::Motion pose(int n) const
    {
        lie::Motion at;
        if (n >= 0)
            at.r = bodies[static_cast<std::size_t>(n)].r, at.A = bodies[static_cast<std::size_t>(n)].A;
        return at;
    }

    /// Adds a shape to the kind of those that are alike.
    void add(const ImportedShape& shape)
    {
        OwnedShape one{.of = &shape, .owner = owner(shape.body), .shape = {}, .keys = {}};
        const lie::Motion body = pose(one.owner);
        try {
            one.shape.surface = surface_of(shape, one.keys);
        } catch (const io::InvalidInput& error) {
            model.warnings.push_back(fmt::format("{}: {}", shape.name, reason_of(error)));
            return;
        }
        const Vec3 arm = body.A.transpose() * (shape.p - body.r);
        const double size = shape.p.norm() + body.r.norm();
        one.shape.position = without_noise(arm, size);
        one.shape.orientation = body.A.transpose() * shape.A;
        for (int k = 0; k < 3; ++k)
            one.shape.orientation.col(k) = without_noise(one.shape.orientation.col(k), 1);
        if (one.shape.position != Vec3::Zero()) one.keys["position"] = dae::json(one.shape.position);
        if (!one.shape.orientation.isIdentity(1e-14))
            one.keys["A"] = dae::json(one.shape.orientation);
        else
            one.shape.orientation = Mat3::Identity();
        for (Kind& kind : kinds)
            if (one.owner >= 0 && kind[0].owner >= 0 && are_alike(kind[0], one) &&
                std::none_of(kind.begin(), kind.end(),
                             [&](const OwnedShape& other) { return other.owner == one.owner; })) {
                kind.push_back(std::move(one));
                return;
            }
        kinds.push_back({std::move(one)});
    }

    bool is_jointed_to(int body, int parent) const
    {
        const ImportedBody& of = bodies[static_cast<std::size_t>(body)];
        return owner(of.parent) == parent && of.joints.front().type != ImportedJoint::free;
    }

    bool may_touch(const OwnedShape& a, const OwnedShape& b) const
    {
        if (a.owner == b.owner) return false;
        if ((a.of->type_mask & b.of->partner_mask) == 0 && (b.of->type_mask & a.of->partner_mask) == 0)
            return false;
        if (model.without_contact.contains(std::minmax(a.of->body, b.of->body))) return false;
        const OwnedShape &ground = a.owner < 0 ? a : b, &moving = a.owner < 0 ? b : a;
        if (ground.owner < 0) return ground.of->touches_neighbours || !is_jointed_to(moving.owner, -1);
        return !is_jointed_to(a.owner, b.owner) && !is_jointed_to(b.owner, a.owner);
    }

    /// Why a pair has no contact at the start: an overlap, or poses without a contact point. Empty if it has
    /// one or is apart.
    std::string start_problem(const contact::Detector& detector, const OwnedShape& a,
                              const OwnedShape& b) const
    {
        const lie::Motion at_a = pose(a.owner), at_b = pose(b.owner);
        const double distance =
            (at_a.r + at_a.A * a.shape.position - at_b.r - at_b.A * b.shape.position).norm();
        if (distance > a.shape.surface->bounding_radius() + b.shape.surface->bounding_radius()) return "";
        contact::Manifold points;
        try {
            detector.detect_all(at_a, at_b, 0, points);
        } catch (const lie::NumericalFailure& error) {
            return ": " + reason_of(error);
        }
        double depth = 0;
        for (const contact::ManifoldPoint& p : points) depth = std::max(depth, -p.at.gap);
        if (!(depth > accepted_overlap * smaller_size(a.shape, b.shape))) return "";
        return fmt::format(", which overlap by {:.3g} m at the start", depth);
    }

    /// Adds the contacts between the shapes of two kinds, or of one.
    void add_pairs_of(const Kind& first, const Kind& second, bool same)
    {
        std::vector<std::pair<const OwnedShape*, const OwnedShape*>> pairs;  // at most most_entries + 1
        long possible = 0, count = 0;
        LeftOut without_detector, at_start;
        std::unique_ptr<contact::Detector> detector;
        for (std::size_t i = 0; i < first.size(); ++i)
            for (std::size_t j = same ? i + 1 : 0; j < second.size(); ++j) {
                const OwnedShape &a = first[i], &b = second[j];
                ++possible;
                if (!may_touch(a, b)) continue;
                if (detector == nullptr && without_detector.count == 0)
                    detector = detector_of(a, b, without_detector);
                else if (detector == nullptr)
                    ++without_detector.count;
                if (detector == nullptr) continue;
                if (const std::string problem = start_problem(*detector, a, b); !problem.empty()) {
                    at_start.add(a, b, problem);
                } else {
                    ++count;
                    if (pairs.size() <= most_entries) pairs.emplace_back(&a, &b);
                }
            }
        for (LeftOut* out : {&without_detector, &at_start}) out->warn(model.warnings);
        model.contact_pairs += count;
        if (count > 1 && count == possible && (same || are_disjoint(first, second)))
            return add_group(first, second, same);
        for (const auto& [a, b] : pairs)
            add_entry(name_of(a->owner) + "-" + name_of(b->owner), name_of(a->owner), name_of(b->owner), *a,
                      *b);
    }

    /// The pairs of equal geometries that are left out for one reason. The first ones are named.
    struct LeftOut {
        static constexpr std::size_t most_named = 20;
        std::vector<std::string> named;
        long count = 0;

        void add(const OwnedShape& a, const OwnedShape& b, const std::string& why)
        {
            ++count;
            if (named.size() < most_named)
                named.push_back(fmt::format("contact of {} with {}{}", a.of->name, b.of->name, why));
        }
        void warn(std::vector<std::string>& warnings)
        {
            if (const long others = count - static_cast<long>(named.size()); others > 0)
                named.back() +=
                    "; and " + io::counted(others, "other pair", "other pairs") + " of equal geometries";
            for (const std::string& text : named)  // the two ends of a cylinder have the same text
                if (std::find(warnings.begin(), warnings.end(), text) == warnings.end())
                    warnings.push_back(text);
        }
    };

    /// The detector of a pair, or nullptr and the reason in `out`
    static std::unique_ptr<contact::Detector> detector_of(const OwnedShape& a, const OwnedShape& b,
                                                          LeftOut& out)
    {
        try {
            return make_detector(a.shape, b.shape);
        } catch (const io::InvalidInput& error) {
            out.add(a, b, ": " + reason_of(error));
            return nullptr;
        }
    }

    static bool are_disjoint(const Kind& first, const Kind& second)
    {
        return std::none_of(first.begin(), first.end(), [&](const OwnedShape& a) {
            return std::any_of(second.begin(), second.end(),
                               [&](const OwnedShape& b) { return a.owner == b.owner; });
        });
    }

    /// The names of several bodies as a list, that of one as a text
    io::Json names_of(const Kind& kind) const
    {
        if (kind.size() == 1) return name_of(kind[0].owner);
        io::Json::List names;
        for (const OwnedShape& shape : kind) names.emplace_back(name_of(shape.owner));
        return names;
    }

    void add_group(const Kind& first, const Kind& second, bool same)
    {
        const std::string name = fmt::format("group_{}", ++groups);
        if (!same) return add_entry(name, names_of(first), names_of(second), first[0], second[0]);
        io::Json one = {{"name", unique(name)}, {"bodies", names_of(first)}, {"surface", first[0].keys}};
        finish(std::move(one), *first[0].of, *first[0].of);
    }

    void add_entry(const std::string& name, io::Json body_i, io::Json body_j, const OwnedShape& a,
                   const OwnedShape& b)
    {
        finish({{"name", unique(name)},
                {"body_i", std::move(body_i)},
                {"body_j", std::move(body_j)},
                {"surface_i", a.keys},
                {"surface_j", b.keys}},
               *a.of, *b.of);
    }

    std::string unique(const std::string& name)
    {
        std::string own = name;
        for (int k = 2; !names.insert(own).second; ++k) own = fmt::format("{}_{}", name, k);
        return own;
    }

    void finish(io::Json one, const ImportedShape& a, const ImportedShape& b)
    {
        one["normal"] = {{"type", "dvi"}};
        if (const double mu = friction(a, b); mu > 0) one["friction"] = {{"law", "coulomb"}, {"mu_s", mu}};
        all.push_back(std::move(one));
        if (all.size() > most_entries)
            throw io::InvalidInput(fmt::format(
                "{}: --contacts: the model would have more than {} contacts of single pairs of geometries",
                file, most_entries));
    }

    ImportedModel& model;
    const std::vector<ImportedBody>& bodies;
    const std::vector<int>& owners;
    const std::string& file;
    std::vector<Kind> kinds;
    std::set<std::string> names;
    int groups = 0;
    io::Json all = io::Json::array();
};

}  // namespace

io::Json imported_contacts(ImportedModel& model, const std::vector<ImportedBody>& bodies,
                           const std::vector<int>& owners, const std::string& file)
{
    return ContactWriter(model, bodies, owners, file).contacts();
}

}  // namespace hilda::run
