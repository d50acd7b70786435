#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The JSON Schema of the model file describes every key, accepts the valid models and rejects the invalid ones.

    schema_test.py [FILE ...]       FILEs are further models that the schema must accept
"""
import json
import pathlib
import sys

import jsonschema

root = pathlib.Path(__file__).resolve().parents[2]
models = root / "tests" / "data" / "models"
sys.path.insert(0, str(root / "tests" / "support"))
from schema_rules import faults_of_text  # noqa: E402

# A build can add surfaces and friction laws, so the schema accepts every name. Only the program rejects these files.
# The schema accepts every expression in a string.
rejected_by_program_only = {"contact_unknown_surface.json", "mass_as_text.json"}


def read(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def main():
    schema = read(root / "dae" / "model.schema.json")
    validator_class = jsonschema.validators.validator_for(schema)
    validator_class.check_schema(schema)
    validator = validator_class(schema)

    faults = faults_of_text(schema)
    valid = sorted(models.glob("*.json")) + sorted((models / "contacts").glob("*.json"))
    valid += [pathlib.Path(file) for file in sys.argv[1:]]
    invalid = sorted((models / "bad").glob("*.json"))
    for path in valid:
        for error in validator.iter_errors(read(path)):
            faults.append(f"{path.name}: {error.json_path}: {error.message[:200]}")
    for path in invalid:
        if validator.is_valid(read(path)) != (path.name in rejected_by_program_only):
            faults.append(f"{path.name} is {'rejected' if path.name in rejected_by_program_only else 'accepted'}")
    if len(valid) < 5 or len(invalid) < 15:
        faults.append(f"only {len(valid)} valid and {len(invalid)} invalid models in {models.name}")

    for fault in faults:
        print(fault)
    print(f"{len(valid)} models accepted, {len(invalid) - len(rejected_by_program_only)} rejected, {len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
