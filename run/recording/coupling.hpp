// SPDX-License-Identifier: GPL-3.0-or-later
/// What a run of a mechanism calls if its loads come from another program that advances with it.

#pragma once

#include "lie/so3.hpp"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace hilda::dae {
struct Description;
}
namespace hilda::lie {
class March;
}  // namespace hilda::lie

namespace hilda::run {

/// A body on which the other side acts
struct CoupledTool {
    std::string name;  ///< of the body
    int body = 0;
    /// Impulses of the last exchange, about the centre of mass, global frame [N s, N m s]
    lie::Vec3 P = lie::Vec3::Zero(), L = lie::Vec3::Zero();
    double work = 0;   ///< of the impulses with the motion that the other side assumes [J]
    bool acts = true;  ///< whether the impulses belong to the node that was computed last
};

/// The functions throw io::InvalidInput, io::IoError, io::UsageError and io::NumericalFailure.
class Coupling {
public:
    virtual ~Coupling() = default;

    /// Adds the forces of the coupling to a model before its start. `node`: number of the node from which a
    /// resumed run continues; empty for a new run.
    virtual void prepare(dae::Description& description, std::optional<long> node) = 0;
    /// Called once after the start or after a checkpoint has been restored, before the first step. `warn`
    /// receives warnings.
    virtual void begin(const lie::March& march, const std::function<void(const std::string&)>& warn) = 0;
    /// Sets the loads of the next step.
    virtual void before_step(lie::March& march) = 0;
    /// Called before the last node, which has the loads of the last step, is passed to the outputs.
    virtual void before_finish() = 0;
    /// Writes a checkpoint of the other side for the present node, before that of the mechanism.
    virtual void save() = 0;
    /// The bodies, with the loads at the node that was computed last
    virtual const std::vector<CoupledTool>& tools() const = 0;
    /// Ends the other side, with the exit code of the run.
    virtual void close(int code) = 0;
};

}  // namespace hilda::run
