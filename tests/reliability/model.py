# SPDX-License-Identifier: GPL-3.0-or-later
"""A valid model with joints, forces and a contact, which the rows change."""
import copy
import json

MODEL = {
    "hilda_model": 1, "name": "bench", "gravity": [0, 0, -9.81], "end": 1,
    "bodies": [
        {"name": "bar", "mass": 3, "inertia": [0.01, 1, 1], "r": [1, 0, 0]},
        {"name": "bob", "mass": 0.5, "inertia": [1, 1, 1], "r": [3, 0, 0]},
        {"name": "ball", "mass": 0.5, "inertia": [2e-3, 2e-3, 2e-3], "r": [9, 0, 0.1]}],
    "constraints": [
        {"name": "pin", "type": "revolute", "body_i": "ground", "body_j": "bar",
         "s_bar_q_j": [-1, 0, 0], "axis_bar_i": [0, 1, 0], "axis_bar_j": [0, 1, 0]},
        {"name": "knee", "type": "spherical", "body_i": "bar", "body_j": "bob",
         "s_bar_p_i": [1, 0, 0], "s_bar_q_j": [-1, 0, 0]}],
    "forces": [
        {"name": "spring", "type": "spring-damper", "body_i": "ground", "body_j": "bob", "s_bar_p_i": [3, 0, 4],
         "stiffness": 10, "damping": 0.1, "free_length": 1},
        {"name": "wind", "type": "force", "body": "bob", "point_bar": [0, 0, 0],
         "frame": "global", "components": ["cos(t)", 0, 1]}],
    "contacts": [
        {"name": "floor", "body_i": "ground", "body_j": "ball",
         "surface_i": {"type": "plane"}, "surface_j": {"type": "sphere", "radius": 0.1},
         "normal": {"type": "hertz", "E_star": 1e6}, "friction": {"mu_s": 0.3, "mu_k": 0.2, "K_E": 1e4}}]}


def valid():
    return copy.deepcopy(MODEL)


def at(tree, pointer):
    """The container and the key of a JSON pointer"""
    parts = [part.replace("~1", "/").replace("~0", "~") for part in pointer.strip("/").split("/")]
    for part in parts[:-1]:
        tree = tree[int(part)] if isinstance(tree, list) else tree[part]
    return tree, int(parts[-1]) if isinstance(tree, list) else parts[-1]


def changed(pointer, value):
    """The model with another value at a JSON pointer"""
    model = valid()
    container, key = at(model, pointer)
    container[key] = value
    return model


def text(model):
    return json.dumps(model)
