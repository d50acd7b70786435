// SPDX-License-Identifier: GPL-3.0-or-later
/// Mechanisms on a bed of grains, for studies: the bed, the files of a run of hilda cosim, and its results.
///
/// The files of a run remain in the output directory of the study, in runs/NAME: model.json, case.json and
/// cosim.json. `hilda cosim runs/NAME/cosim.json` repeats it.

#pragma once

#include "io/formats/csv_table.hpp"
#include "io/json.hpp"
#include "studies/framework/table.hpp"

#include <string>
#include <vector>

namespace hilda::studies {

class StudyContext;

/// A bed of equal spheres of rock, with the force model of Fang (2022), Sec. 7.2.6: scaled Hooke springs,
/// incremental friction, rolling friction of constant magnitude
struct RigBed {
    double length = 0, width = 0, depth = 0;  ///< along x and y; of the loose grains before they settle [m]
    double R = 0;                             ///< radius of the grains [m]
    double k = 0;                             ///< normal and tangential stiffness at an overlap of R [N/m]
    double h = 0;                             ///< step [s]
    bool periodic = false;                    ///< along y; otherwise walls
    double mu = 0.9, mu_r = 0.2;              ///< coefficients of sliding and of rolling friction
    long number = 1;                          ///< of the bed: the seed of its fill
};

/// Impulses, motion and work of a body of a run, from tools.csv, and the grains at its end
struct RigRun {
    io::CsvTable tools;
    /// Centres, y and speed of all grains at the end [m, m/s]
    std::vector<double> x = {}, y = {}, z = {}, speed = {};
    double work_on_grains = 0;  ///< of the boundaries, from the energy balance of the grains [J]
    double dissipated = 0;      ///< by the contacts [J]

    /// Mean of a column over the rows after a time
    double mean(const std::string& column, double after) const;
    double last(const std::string& column) const;
};

class Rigs {
public:
    /// Makes the folder of the runs: below the output directory of the study, or a temporary one, which the
    /// destructor removes.
    explicit Rigs(const StudyContext& study);
    ~Rigs();
    Rigs(const Rigs&) = delete;
    Rigs& operator=(const Rigs&) = delete;

    /// Lets the grains of a bed settle with a coefficient of friction of 0.1, for a dense bed. Returns the
    /// height of its highest point [m]. The runs with this number of the bed begin with it. Throws
    /// io::Failure.
    double settle(const RigBed& bed);

    /// Runs a model with `substeps` steps of the grains in each step of the mechanism. `pair`: body, boundary
    /// and r, see cosim.schema.json. Throws io::Failure.
    RigRun run(const std::string& name, const RigBed& bed, const io::Json& model, const io::Json& boundaries,
               const io::Json& pair, long substeps, double end) const;

private:
    /// Makes the folder of a run and reports its beginning.
    std::string folder_of(const std::string& parent, const std::string& name) const;

    const StudyContext& study;
    std::string folder, bed_folder, temporary;  ///< of the runs, of the bed; "": none
};

/// Adds the rows of a matrix, stored by rows with this number of columns, after the cells of a key.
void add_rows(Table& to, const std::vector<Table::Cell>& key, const std::vector<double>& matrix,
              std::size_t columns);

/// Formula of t that rises from 0 at `from` to 1 at `to` with a continuous second derivative
std::string smooth_step(double from, double to);

}  // namespace hilda::studies
