// SPDX-License-Identifier: GPL-3.0-or-later
/// Table euler: Euler angles of all bodies at the output rows, with --euler.

#include "dae/model.hpp"
#include "lie/euler_sequence.hpp"
#include "run/tables/table_sink.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hilda::run {

namespace {

constexpr const char* option = "--euler";

/// Orientation and rotation of a body at a node
struct Rotation {
    lie::Mat3 A = lie::Mat3::Identity();
    lie::Vec3 omega_bar = lie::Vec3::Zero(), omegadot_bar = lie::Vec3::Zero();  ///< [rad/s, rad/s²]

    explicit Rotation(const lie::Motion& body)
        : A(body.A), omega_bar(body.omega_bar), omegadot_bar(body.omegadot_bar)
    {}
};

/// Angle through which a body turns between two nodes, by the larger of its rates [rad]
double turned(const Rotation& from, const Rotation& to, double time)
{
    return time * std::max(from.omega_bar.norm(), to.omega_bar.norm());
}

/// ω̄ at the fraction s of the time between two nodes: cubic polynomial with the values and derivatives of
/// both
lie::Vec3 omega_bar(const Rotation& from, const Rotation& to, double time, double s)
{
    const double r = 1 - s;
    return r * r * (1 + 2 * s) * from.omega_bar + s * s * (3 - 2 * s) * to.omega_bar +
           time * s * r * (r * from.omegadot_bar - s * to.omegadot_bar);
}

/// The first and the third angle are continuous: they are followed from node to node and pass ±π without a
/// jump. Between two nodes of a variable-step integrator a body may turn several times: the angles are
/// followed along the rotation with the interpolated ω̄, and the remaining difference to the orientation of
/// the second node is distributed over it. Where the second angle passes the end of its range, both jump by
/// π, as the angles are singular there.
class EulerAngles final : public TableSink {
public:
    EulerAngles(const RunSetup& run, const std::string& name)
        : TableSink(run, "euler"), model(run.model), axes(name),
          sequence(lie::EulerSequence::named(name).value()), is_zxz(name == "zxz"), warn(run.warn)
    {}

    void transfer(io::Archive& a) override
    {
        TableSink::transfer(a);
        a.value(t);
        std::vector<double> numbers;
        for (const Body& b : last) {
            numbers.insert(numbers.end(), b.angles.begin(), b.angles.end());
            numbers.insert(numbers.end(), b.rotation.A.data(), b.rotation.A.data() + 9);
            for (const lie::Vec3& v : {b.rotation.omega_bar, b.rotation.omegadot_bar})
                numbers.insert(numbers.end(), v.begin(), v.end());
        }
        a.list(numbers);
        constexpr size_t of_body = 18;
        last.clear();
        for (size_t k = 0; k + of_body <= numbers.size(); k += of_body) {
            const double* at = numbers.data() + k;
            Body& b = last.emplace_back();
            b.angles = Eigen::Map<const lie::Vec3>(at);
            b.rotation.A = Eigen::Map<const lie::Mat3>(at + 3);
            b.rotation.omega_bar = Eigen::Map<const lie::Vec3>(at + 12);
            b.rotation.omegadot_bar = Eigen::Map<const lie::Vec3>(at + 15);
        }
    }

private:
    /// A body at the last node
    struct Body {
        lie::Vec3 angles = lie::Vec3::Zero();
        Rotation rotation{lie::Motion()};
    };

    std::vector<TableColumn> columns() const override
    {
        const std::array<const char*, 3> names =
            is_zxz ? std::array{"theta", "phi", "psi"} : std::array{"angle1", "angle2", "angle3"};
        std::vector<TableColumn> all = {time_column};
        for (const dae::Body& body : model.all_bodies())
            for (size_t k = 0; k < names.size(); ++k)
                all.push_back(
                    {body.name + '.' + names[k], "rad",
                     std::array{"first", "second", "third"}[k] + (" Euler angle of the sequence " + axes)});
        return all;
    }

    void append(std::vector<double>& row, const RunNode& node) override
    {
        const bool is_first = last.empty();
        last.resize(node.x.body.size());
        if (node.is_row) row.push_back(node.x.t);
        for (size_t b = 0; b < last.size(); ++b) {
            const Rotation now(node.x.body[b]);
            if (is_first)
                last[b].angles = sequence.angles(now.A);
            else
                follow(b, now, node.x.t - t);
            last[b].rotation = now;
            if (node.is_row) run::append(row, last[b].angles);
        }
        t = node.x.t;
    }

    /// Follows the angles of a body to the next node.
    void follow(size_t b, const Rotation& to, double time)
    {
        constexpr double largest = 0.5;  // [rad]; a body that turns less is not followed between the nodes
        constexpr double most = 1e6;     // parts of the interval
        const Rotation& from = last[b].rotation;
        const double angle = turned(from, to, time);
        if (!(angle > largest)) return pass(b, to.A);
        const int parts = static_cast<int>(std::min(most, std::ceil(2 * angle / largest)));
        std::vector<lie::Mat3> A = {from.A};
        for (int k = 0; k < parts; ++k)
            A.emplace_back(A.back() * lie::exp(time / parts * omega_bar(from, to, time, (k + 0.5) / parts)));
        const Eigen::AngleAxisd rest(lie::Mat3(A.back().transpose() * to.A));
        if (rest.angle() > 0.25 * std::numbers::pi && !has_warned) {
            has_warned = true;
            warn(fmt::format(
                "--euler: the turns of {} are not certain: it turns by {:.3g} rad between two rows, at "
                "t = {:.6g} s; a smaller --interval gives certain angles",
                model.all_bodies()[b].name, angle, t + time));
        }
        for (int k = 1; k < parts; ++k)
            pass(b, A[static_cast<size_t>(k)] *
                        Eigen::AngleAxisd(rest.angle() * k / parts, rest.axis()).toRotationMatrix());
        pass(b, to.A);
    }

    /// The angles of the orientation A, of those that differ by whole turns the nearest to the last ones
    void pass(size_t b, const lie::Mat3& A)
    {
        lie::Vec3 angles = sequence.angles(A);
        for (const int k : {0, 2})
            angles[k] =
                last[b].angles[k] + std::remainder(angles[k] - last[b].angles[k], 2 * std::numbers::pi);
        last[b].angles = angles;
    }

    const dae::Model& model;
    const std::string axes;
    const lie::EulerSequence sequence;
    const bool is_zxz;
    const std::function<void(const std::string&)> warn;
    std::vector<Body> last;  ///< at the last node
    double t = 0;            ///< of the last node [s]
    bool has_warned = false;
};

void check_sequence(const std::string& name, const std::string& text)
{
    if (!lie::EulerSequence::named(text))
        throw io::UsageError(
            name +
            ": must be three of the letters x, y and z in which neighbours differ, such as zxz, got '" +
            text + "'");
}

const bool registered_euler = io::Registry<SinkType>::add(
    {.name = "euler",
     .options = {{.name = option,
                  .value = "SEQUENCE",
                  .help = "write Euler angles of this sequence of axes, such as zxz or zyx, to euler.csv",
                  .check = check_sequence}},
     .make = [](const RunSetup& run) -> std::unique_ptr<io::Sink<RunNode>> {
         const auto given = run.options.find(option);
         if (given == run.options.end()) return nullptr;
         return std::make_unique<EulerAngles>(run, given->second);
     },
     .files = {"euler.csv"}});

}  // namespace

}  // namespace hilda::run
