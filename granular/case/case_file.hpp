// SPDX-License-Identifier: GPL-3.0-or-later
/// Reader of a granular case file (JSON).

#pragma once

#include "granular/case/motion.hpp"
#include "granular/case/output_spec.hpp"
#include "granular/case/settings.hpp"
#include "granular/case/stage_keys.hpp"
#include "granular/insertion/insertion.hpp"
#include "granular/world/groups.hpp"
#include "granular/world/world.hpp"
#include "io/json_source.hpp"

#include <map>
#include <optional>

namespace hilda::granular {

class Stages;

/// A case that is ready to run
struct Case {
    io::JsonSource source;
    std::string name = {};
    std::shared_ptr<Insertions> insertions = {};  ///< nullptr if there are none; outlives the world
    std::unique_ptr<World> world = {};
    double h = 0, end = 0;      ///< step and end time [s]
    double interval = 0;        ///< time between rows of run.csv [s]
    double frame_interval = 0;  ///< time between frames [s]
    OutputSpecs outputs = {};
    std::shared_ptr<Groups> groups = {};  ///< nullptr if there are none
    std::vector<StageSpec> stage_specs = {};
    std::shared_ptr<Stages> stages = {};  ///< of a run with stages, see continuation.hpp; nullptr otherwise
    std::vector<std::string> boundaries = {};         ///< names, by number
    std::vector<std::size_t> entry_of_boundary = {};  ///< its index in `boundaries` of the case, by number
    std::vector<int> moving = {};                     ///< numbers of the boundaries that move
    /// Formulas of the boundaries, which the world evaluates in each step
    std::shared_ptr<std::vector<BoundaryMotion>> motions = std::make_shared<std::vector<BoundaryMotion>>();
    std::vector<std::string> notices = {};   ///< warnings, with their location
    std::vector<std::string> doubtful = {};  ///< those of `notices` that --strict refuses
    std::string files_read = {};             ///< names and checksums of the other files that were read
    /// Id of the first particle of each entry of `particles` and `fill`, and the JSON pointer of the entry
    std::vector<std::pair<std::uint32_t, std::string>> entries = {};
    std::map<std::string, std::string> tables = {};  ///< table file of an entry of `fill`, by its pointer
};

/// Limits and options that the program passes to the reader
struct Environment {
    static constexpr std::size_t any = std::numeric_limits<std::size_t>::max();

    std::size_t memory = any, device_memory = any;  ///< available memory of the host and of the GPU [bytes]
    bool lists_contacts = false;                    ///< whether a table of all contacts is written
    Device device = {};
    std::vector<Setting> settings = {};      ///< changes of entries, applied in this order
    std::optional<std::uint64_t> seed = {};  ///< seed of the first fill; the next fills have seed + 1, ...
    std::string folder = {};  ///< that contains all files which the case names; empty: they may be anywhere
    std::string base = {};    ///< folder of relative names of files; empty: the current one
    bool removable = false;   ///< whether World::remove() is used beside stages
    /// Case of the run that is continued, or nullptr. Its intervals replace those that the case does not
    /// state.
    const io::JsonSource* continues = nullptr;
    bool with_particles = true;  ///< otherwise those of `particles` and `fill` are read and not added
};

/// Reads a case and constructs its world. `file` is the name used in messages. The required memory is
/// estimated and compared with the available memory before the particles are generated.
///
/// Throws io::InvalidInput with file, line, column and JSON pointer of the invalid entry, and DeviceError.
Case read_case(const std::string& text, const std::string& file, const Environment& environment = {});
/// The same of a text that was read before. The changes of the environment are not applied.
Case read_case(const io::JsonSource& source, const Environment& environment);

/// The case file, if it is one, and the files that it names, as io::inputs()
io::Json inputs_of(const Case& c, const std::string& file);

/// Inserts the particles into the world. Throws io::InvalidInput with the place of the entry whose particles
/// are invalid.
void insert_particles(const Case& c);

}  // namespace hilda::granular
