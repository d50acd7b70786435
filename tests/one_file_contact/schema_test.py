#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The printed schema knows the keys of a surface, a friction law and a normal law that a build adds.

    schema_test.py HILDA MODEL
"""
import copy
import json
import pathlib
import subprocess
import sys

import jsonschema


def main():
    schema = json.loads(subprocess.run([sys.argv[1], "schema"], check=True, capture_output=True).stdout)
    validator = jsonschema.validators.validator_for(schema)(schema)
    model = json.loads(pathlib.Path(sys.argv[2]).read_text(encoding="utf-8"))
    power = {"type": "demo-power", "k": 1e6, "p": 1.5}
    changes = [  # (path in the contact, value, valid)
        ("normal", power, True),
        ("normal", {"type": "constraint", "unilateral": True, "fallback": power}, True),
        ("normal", {**power, "p": 0.5}, False),
        ("normal", {**power, "E_star": 1e6}, False),
        ("normal", {"type": "no-law"}, False),
        ("surface_i", {"type": "demo-egg", "radius": 0.1, "concave": True}, False),
        ("surface_i", {"type": "demo-egg"}, False),
        ("friction", {"law": "demo-oil", "mu_s": 0.3, "K_E": 1e4}, False),
        ("friction", {"law": "demo-oil", "mu_s": 0.3, "K_E": 1e4, "viscosity": 3, "eta_r": 0.1}, False),
    ]
    faults = [error.message for error in validator.iter_errors(model)]
    for key, value, valid in changes:
        changed = copy.deepcopy(model)
        changed["contacts"][0][key] = value
        if validator.is_valid(changed) != valid:
            faults.append(f"{key} {json.dumps(value)} is {'rejected' if valid else 'accepted'}")
    print("\n".join(faults) or f"{len(changes) + 1} models judged correctly")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
