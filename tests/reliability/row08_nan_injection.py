#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Row 8: values that are not finite or overflow, at 12 points x 7 integrators, end the run with exit code 4 (3 where
the reader sees them), with the name of the entity, and no table has a value that is not finite."""
import json

import matrix
import model as models

INTEGRATORS = ("rA-half-1", "rA-half-1-momentum", "rA-full-1", "rA-rattle", "rA-rkmk-4", "rA-dp-5", "rA-dop853",
               "rA-radau-5")
STEP = 5e-4  # below the stability limit of the contact of the model, 9.9e-4 s for schemes that extrapolate velocities


def points():
    """Name of the point, model, name that the message must contain"""
    def force(**changes):
        m = models.valid()
        m["forces"][1].update(changes)
        return m
    yield "force", force(components=["sqrt(0.0205-t)", 0, 0]), "wind"
    yield "force that overflows", force(components=[0, 0, "exp(1e5*(t-0.02))"]), "b"
    motor = {"name": "motor", "type": "torque", "body": "bob", "frame": "global", "components": [0, "log(0.0205-t)", 0]}
    yield "torque", {**models.valid(), "forces": [motor]}, "motor"
    yield "spring", models.changed("/forces/0/force", "sqrt(0.0205-t)"), "spring"
    yield "gravity", models.changed("/gravity", [0, 0, -1e308]), ""
    yield "velocity", models.changed("/bodies/2/r_dot", [1e300, 0, 0]), "ball"
    yield "angular velocity", models.changed("/bodies/2/omega", [0, 0, 1e200]), "ball"
    # The step is above the stability limit of the contact.
    yield "inertia", models.changed("/bodies/2/inertia", [1e-320, 1e-320, 1e-320]), "floor"
    yield "stiffness", models.changed("/contacts/0/normal/E_star", 1e308), "floor"
    yield "contact friction", models.changed("/contacts/0/friction/K_E", 1e308), "floor"
    driver = models.valid()
    driver["constraints"].append({"name": "turn", "type": "hinge-driver", "body_i": "ground", "body_j": "bar",
                                  "axis_bar_i": [0, 1, 0], "axis_bar_j": [0, 1, 0],
                                  "angle": "0.1*t+0*sqrt(0.0205-t)"})
    yield "driver", driver, "turn"
    rod = models.valid()
    rod["constraints"].append({"name": "rod", "type": "CD", "body_i": "ground", "body_j": "ball",
                               "c": [0, 1, 0], "f": "0*log(0.0205-t)"})
    yield "constraint", rod, "rod"


def main():
    row = matrix.Row("8 NaN injection")
    with matrix.scratch() as folder:
        for what, model, name in points():
            (folder / "bad.json").write_text(json.dumps(model))
            for integrator in INTEGRATORS:
                row.run(["rm", "-rf", "out"], cwd=folder)
                ended = row.run([row.hilda, "run", "bad.json", "--integrator", integrator, "--step", STEP,
                                 "--interval", 1e-3, "--end", 0.05, "--output", "out", "--quiet"], cwd=folder, limit=60)
                file = folder / "out/trajectory.csv"
                bad = matrix.bad_values(file) if file.exists() else 0
                row.case(f"{what} {integrator}", ended.code in (2, 3, 4) and name in ended.err and bad == 0,
                         f"exit {ended.code}, {bad} values that are not finite: {ended.err}")
    row.end()


main()
