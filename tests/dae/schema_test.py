#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The JSON Schema of the model file accepts the good models and refuses the bad ones.

    schema_test.py [FILE ...]       FILEs are further models that it must accept
"""
import json
import pathlib
import sys

import jsonschema

root = pathlib.Path(__file__).resolve().parents[2]
models = root / "tests" / "data" / "models"

# Any name of a surface or of a friction law may be one that a build has: these only the program can refuse.
left_to_the_program = {"contact_unknown_surface.json"}


def read(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def without_description(node, path="#"):
    """Places of the schema that say what a key is, but not in words."""
    if not isinstance(node, dict):
        return
    for key, value in node.get("properties", {}).items():
        plain = isinstance(value, dict) and "const" not in value and "enum" not in value
        if plain and "description" not in value and value.get("$ref") not in ("#/$defs/id", "#/$defs/note"):
            yield f"{path}/{key}"
    for key, value in node.items():
        if isinstance(value, dict):
            yield from without_description(value, f"{path}/{key}")


def main():
    schema = read(root / "dae" / "model.schema.json")
    validator_class = jsonschema.validators.validator_for(schema)
    validator_class.check_schema(schema)
    validator = validator_class(schema)

    faults = [f"{place} has no description" for place in without_description(schema)]
    good = sorted(models.glob("*.json")) + sorted((models / "contacts").glob("*.json"))
    good += [pathlib.Path(file) for file in sys.argv[1:]]
    bad = sorted((models / "bad").glob("*.json"))
    for path in good:
        for error in validator.iter_errors(read(path)):
            faults.append(f"{path.name}: {error.json_path}: {error.message[:200]}")
    for path in bad:
        if validator.is_valid(read(path)) != (path.name in left_to_the_program):
            faults.append(f"{path.name} is {'refused' if path.name in left_to_the_program else 'accepted'}")
    if len(good) < 5 or len(bad) < 15:
        faults.append(f"only {len(good)} good and {len(bad)} bad models in {models.name}")

    for fault in faults:
        print(fault)
    print(f"{len(good)} models accepted, {len(bad) - len(left_to_the_program)} refused, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
