// SPDX-License-Identifier: GPL-3.0-or-later
/// Example of an output format in one file: momentum.csv, the momentum of all bodies and its largest value so
/// far. Written with --momentum DIGITS.

#include "dae/model.hpp"
#include "io/error.hpp"
#include "io/message.hpp"
#include "run/tables/sink.hpp"

#include <algorithm>

namespace hilda::run {
namespace {

class DemoMomentum final : public RowsSink {
public:
    explicit DemoMomentum(const RunSetup& run)
        : RowsSink(run.directory, "momentum.csv"), model(run.model),
          digits(run.options.at("--momentum")[0] - '0')
    {}

    /// What a resumed run needs, besides the length of the file
    void transfer(io::Archive& a) override
    {
        RowsSink::transfer(a);
        a.value(largest);
    }

private:
    std::string header() const override { return "t,px,py,pz,largest\n"; }

    void append(std::string& text, const RunNode& node) override
    {
        lie::Vec3 p = lie::Vec3::Zero();
        for (int b = 0; b < model.bodies(); ++b) p += model.mass().m[b] * node.x.body[b].rdot;
        largest = std::max(largest, p.norm());
        if (!node.is_row) return;
        text += io::formatted("%.12g", node.x.t);
        for (const double value : {p.x(), p.y(), p.z(), largest})
            text += io::formatted(",%.*g", digits, value);
        text += '\n';
    }

    const dae::Model& model;
    const int digits;
    double largest = 0;  ///< over all nodes [kg m/s]
};

void check_digits(const std::string& option, const std::string& text)
{
    if (text.size() != 1 || text[0] < '1' || text[0] > '9')
        throw io::UsageError(option + ": must be a digit from 1 to 9, got '" + text + "'");
}

const bool registered = io::Registry<SinkType>::add(
    {.name = "momentum",
     .options = {{.name = "--momentum",
                  .value = "DIGITS",
                  .help = "write momentum.csv as well, with this number of digits",
                  .check = check_digits}},
     .make = [](const RunSetup& run) -> std::unique_ptr<io::Sink<RunNode>> {
         if (!run.options.contains("--momentum")) return nullptr;
         return std::make_unique<DemoMomentum>(run);
     },
     .files = {"momentum.csv"}});

}  // namespace
}  // namespace hilda::run
