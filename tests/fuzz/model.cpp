// SPDX-License-Identifier: GPL-3.0-or-later
#include "dae/model.hpp"
#include "dae/model_file.hpp"
#include "dae/start.hpp"
#include "io/error.hpp"
#include "tests/fuzz/targets.hpp"

#include <string>

namespace hilda::fuzz {

void model(std::string_view input)
{
    try {
        dae::Description d = dae::read_model(std::string(input), "model.json");
        constexpr int most_bodies = 10;
        if (d.model->bodies() <= most_bodies) dae::start(d);
    } catch (const io::InvalidInput&) {
    } catch (const io::NumericalFailure&) {
    } catch (const io::UsageError&) {
    }
}

}  // namespace hilda::fuzz
