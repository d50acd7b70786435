// SPDX-License-Identifier: GPL-3.0-or-later
/// euler.csv: Euler angles of all bodies at the output rows, with --euler.

#include "dae/model.hpp"
#include "io/csv.hpp"
#include "lie/euler_sequence.hpp"
#include "studies/running/sink.hpp"

#include <cmath>
#include <numbers>

namespace hilda::studies {

namespace {

constexpr const char* option = "--euler";

/// The first and the third angle are continuous: they are followed from step to step and pass ±π without a
/// jump. Where the second angle passes the end of its range, both jump by π, as the angles are singular
/// there.
class EulerAngles final : public RowsSink {
public:
    EulerAngles(const RunSetup& run, const std::string& name)
        : RowsSink(run.directory, "euler.csv"), model(run.model),
          sequence(lie::EulerSequence::named(name).value()), is_zxz(name == "zxz")
    {}

    void transfer(io::Archive& a) override
    {
        RowsSink::transfer(a);
        std::vector<double> numbers;
        for (const lie::Vec3& v : last) numbers.insert(numbers.end(), v.begin(), v.end());
        a.list(numbers);
        last.clear();
        for (size_t k = 0; k + 2 < numbers.size(); k += 3)
            last.emplace_back(numbers[k], numbers[k + 1], numbers[k + 2]);
    }

private:
    std::string header() const override
    {
        const std::array<const char*, 3> names =
            is_zxz ? std::array{"theta", "phi", "psi"} : std::array{"angle1", "angle2", "angle3"};
        std::string row = "t";
        for (const dae::Body& body : model.all_bodies())
            for (const char* angle : names) row += ',' + io::csv_field(body.name + '.' + angle);
        return row + '\n';
    }

    void append(std::string& row, const RunNode& node) override
    {
        const bool is_first = last.empty();
        last.resize(node.x.body.size());
        if (node.is_row) io::append_number(row, node.x.t);
        for (size_t b = 0; b < last.size(); ++b) {
            lie::Vec3 angles = sequence.angles(node.x.body[b].A);
            for (const int k : {0, 2})
                if (!is_first)
                    angles[k] = last[b][k] + std::remainder(angles[k] - last[b][k], 2 * std::numbers::pi);
            last[b] = angles;
            if (node.is_row) io::append_vector(row, angles);
        }
        if (node.is_row) row += '\n';
    }

    const dae::Model& model;
    const lie::EulerSequence sequence;
    const bool is_zxz;
    std::vector<lie::Vec3> last;  ///< angles of the bodies at the last node
};

void check_sequence(const std::string& name, const std::string& text)
{
    if (!lie::EulerSequence::named(text))
        throw io::UsageError(
            name +
            ": must be three of the letters x, y and z in which neighbours differ, such as zxz, got '" +
            text + "'");
}

const bool registered = io::Registry<SinkType>::add(
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

}  // namespace hilda::studies
