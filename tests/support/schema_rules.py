# SPDX-License-Identifier: GPL-3.0-or-later
"""Rules for the text of a JSON Schema: every key is described, with unit, frame and valid examples."""
import re

import jsonschema

NUMERIC = {"vector", "matrix", "direction", "formula", "formulas", "positive", "not_negative"}
WITH_FRAME = {"vector", "direction", "formulas"}


def key_schemas(node, path="#"):
    """Yields (path, subschema) for every key that an object of the schema can have. Conditions are left out."""
    for key, value in node.get("properties", {}).items():
        yield f"{path}/{key}", value
        yield from key_schemas(value, f"{path}/{key}")
    if isinstance(node.get("items"), dict):
        yield from key_schemas(node["items"], path)


def faults_of_text(schema):
    """Messages for keys and object types of the schema whose description is incomplete."""
    definitions = schema["$defs"]
    validator_class = jsonschema.validators.validator_for(schema)

    def target(node):
        return node["$ref"].rsplit("/", 1)[1] if "$ref" in node else None

    def description(node):
        while "description" not in node and "$ref" in node:
            node = definitions[target(node)]
        return node.get("description", "")

    def is_numeric(node):
        name = target(node)
        if name in NUMERIC:
            return True
        if name is not None:
            return is_numeric(definitions[name])
        return node.get("type") in ("number", ["number", "string"]) or (node.get("type") == "array" and is_numeric(node["items"]))

    def invalid_values(node, words):
        with_definitions = {**{k: v for k, v in node.items() if k != "$defs"}, "$defs": definitions}
        validator = validator_class(with_definitions)
        for value in node.get(words, []) if words == "examples" else [node[words]] if words in node else []:
            for error in validator.iter_errors(value):
                yield f"{words} {value}: {error.message[:200]}"

    faults = []
    objects = [("#", schema)] + [(f"#/$defs/{name}", node) for name, node in definitions.items()]
    for path, node in objects:
        if "title" in node:
            if not description(node):
                faults.append(f"{path} has a title and no description")
            if "examples" not in node and not {"oneOf", "allOf"} & set(node):
                faults.append(f"{path} has a title and no example")
            faults += [f"{path}: {fault}" for fault in invalid_values(node, "examples")]
        for place, value in key_schemas(node, path):
            text = description(value)
            if not text.endswith("."):
                faults.append(f"{place} has no description that ends with a full stop")
            if value.get("deprecated") or "const" in value and "examples" not in value:
                continue
            where = definitions[target(value)] if "examples" not in value and "$ref" in value else value
            if "examples" not in where and "/fallback/" not in place:
                faults.append(f"{place} has no examples")
            faults += [f"{place}: {fault}" for words in ("examples", "default") for fault in invalid_values(value, words)]
            if is_numeric(value) and not re.search(r"\[[^\]]+\]|\bunit\b", text):
                faults.append(f"{place} has no unit; write [-] for a number without dimension")
            if target(value) in WITH_FRAME and "frame" not in text:
                faults.append(f"{place} does not state its frame")
    titles = [node["title"] for _, node in objects if "title" in node]
    faults += [f"the title '{title}' is used twice" for title in sorted(set(titles)) if titles.count(title) > 1]
    return faults
