#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The JSON Schema of the granular case describes every key. Schema and program accept and reject the same cases.

    schema_test.py PROGRAM
"""
import copy
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import jsonschema

root = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(root / "tests" / "support"))
from schema_rules import faults_of_text  # noqa: E402

# A case with every key that is not deprecated
EVERYTHING = {
    "hilda_case": 1, "name": "everything", "note": "a case with every key",
    "domain": {"low": [-1, -1, -1], "high": [2, 2, 2], "periodic": [False, True, False]},
    "gravity": [0, 0, -1.62], "step": 1e-5, "end": 2e-5, "interval": 1e-5, "frame_interval": 2e-5, "checkpoint_interval": 1e-5, "skin": 0.2,
    "integrator": "velocity-verlet", "orientation": True,
    "materials": [{"name": "glass", "density": 2500, "E": 7e7, "nu": 0.24},
                  {"name": "steel", "density": 7800, "E": 2e8, "nu": 0.3}],
    "laws": [{"between": ["glass", "glass"], "restitution": 0.9, "mu": 0.3, "mu_s": 0.4,
              "note": "glass", "normal": {"law": "hertz", "clamped": True},
              "tangential": {"law": "mindlin", "spring_bound": True, "rescale": False},
              "rolling": {"law": "epsd", "mu_r": 0.1, "eta_r": 0.3}, "spin": {"law": "torsional-spring"},
              "cohesion": {"law": "sjkr", "k": 10}},
             {"between": ["glass", "steel"], "mu": 0.1, "normal": {"law": "hooke", "k_n": 1e4, "gamma_n": 10},
              "tangential": {"law": "coulomb", "k_t": 1e4, "gamma_t": 3},
              "rolling": {"law": "constant-torque", "mu_r": 0.1, "slow": 1e-3, "after": 1e-4, "half_radius": True},
              "cohesion": {"law": "constant", "F_c": 1e-6}},
             {"between": ["steel", "steel"], "restitution": 0, "mu": 0.1, "tangential": {"law": "mindlin-incremental"},
              "rolling": {"law": "pseudo-force", "mu_r": 0.1, "k_r": 2, "eta_r": 0.1}}],
    "boundaries": [{"name": "floor", "type": "plane", "normal": [0, 0, 2], "r": [0, 0, -0.5], "material": "steel"},
                   {"type": "cylinder", "axis": [0, 0, 1], "radius": 0.9, "inside": True, "v": [0, 0, 1], "omega": [0, 0, 1],
                    "material": "glass"},
                   {"type": "cone", "axis": [0, 0, 1], "half_angle": 0.5, "r": [0.5, 0.5, -0.5], "material": "glass"},
                   {"type": "sphere", "radius": 0.1, "r": [-0.5, -0.5, 0], "material": "steel"},
                   {"name": "box", "type": "box", "low": [-1, -1, -1], "high": [1, 1, 2], "open": ["+z"], "r": [0, 0, 0.1],
                    "v": [0, 0, "sin(2*pi*t)"], "material": "steel"},
                   {"name": "lid", "type": "plane", "normal": [0, 0, -1], "r": ["0.1*sin(t)", 0, 1.5], "omega": [0, 0, 0],
                    "mass": 2, "inertia": 1e-3, "free": [False, False, True], "F": [0, 0, "-min(t,1)"], "material": "steel"}],
    "clumps": [{"name": "pair", "material": "steel", "density": 3000,
                "spheres": [{"r": [0.01, 0, 0], "radius": 0.03}, {"r": [-0.01, 0, 0], "radius": 0.03}]},
               {"material": "glass", "mass": 0.3, "inertia": [1e-4, 1e-4, 1.5e-4], "centre": [0.001, 0, 0],
                "spheres": [{"radius": 0.03}]}],
    "particles": [{"r": [0, 0, 0], "radius": 0.05, "material": "glass", "v": [0, 0, 1], "omega": [1, 0, 0], "fixed": False,
                   "force": [0, 1, 0], "replica": 0, "group": "ball", "orientation": [0.6, 0, 0, -0.8]},
                  {"clump": "pair", "r": [-0.5, 0, -0.2], "v": [0, 0, 1], "omega": [1, 0, 0], "replica": 0, "scale": 0.95,
                   "orientation": [0.6, 0, 0, -0.8]}],
    "fill": [{"type": "lattice", "low": [0, 0, 0.2], "high": [0.3, 0.3, 0.5], "radius": 0.05, "least_radius": 0.04,
              "spacing": 1.1, "jitter": 0.5, "count": 5, "seed": 2, "material": "steel", "group": "bed", "v": [0, 0, 0], "random_v": 0.1},
             {"type": "hcp", "low": [-0.6, 0.2, 0.2], "high": [-0.4, 0.4, 0.5], "material": "steel",
              "sizes": {"type": "lognormal", "median": 0.02, "deviation": 0.1, "least_radius": 0.015, "largest_radius": 0.03,
                        "by": "mass"}},
             {"type": "lattice", "low": [-0.2, -0.8, 0.2], "high": [0.2, -0.6, 0.5], "material": "steel",
              "sizes": {"type": "table", "radii": [0.02, 0.03], "passing": [0, 1]}},
             {"type": "lattice", "low": [-0.4, -0.4, -0.3], "high": [-0.2, -0.2, -0.1], "clump": "pair", "radius": 0.042,
              "least_radius": 0.04},
             {"type": "hcp", "low": [-0.4, 0.2, -0.3], "high": [-0.2, 0.4, -0.1], "clump": "clump 1", "orientation": [0, 0, 1, 0]}],
    "insert": [{"name": "feed", "rate": 1e4, "from": 0, "to": 1, "interval": 1e-5, "radius": 0.02, "least_radius": 0.01, "v": [0, 0, -1],
                "random_v": 0.1, "material": "glass", "replica": 0, "on_overlap": "postpone", "tries": 1000, "seed": 3, "count": 50, "active": True, "group": "fed",
                "region": {"type": "cylinder", "r": [0, 0, 0.7], "axis": [0, 0, 1], "radius": 0.3, "length": 0.2}},
               {"mass_rate": 20, "material": "steel", "sizes": {"type": "uniform", "least_radius": 0.01, "largest_radius": 0.02},
                "region": {"type": "disk", "r": [0, 0, 1], "normal": [0, 0, 1], "radius": 0.2}},
               {"count": 3, "material": "steel", "radius": 0.01,
                "region": {"type": "box", "low": [0, 0, 1.1], "high": [0.1, 0.1, 1.2]}},
               {"count": 2, "clump": "pair", "orientation": [0, 1, 0, 0],
                "region": {"type": "box", "low": [-0.2, -0.2, 1.1], "high": [0, 0, 1.2]}}],
    "fields": [{"name": "slice", "low": [-1, -1, -1], "high": [3, 2, 3], "cells": [4, 1, 5], "kernel": "lucy", "width": 0.2,
                "values": "averages", "edges": "closed", "interval": 0.4, "samples": 2, "replica": 0, "group": "ball"},
               {"low": [0, 0, 0], "high": [1, 1, 1], "cells": [1, 1, 1], "width": 0.1, "values": "points", "interval": 1e-5}],
    "contacts": {"interval": 1e-5, "times": [0, 2e-5], "network": True}, "loads": {"interval": 0.4, "samples": 2},
    "stages": [{"name": "settle", "duration": 1e-5, "until": {"kinetic_energy": 1e-9, "share": 1e-4, "from": 1e-5, "interval": 1e-5},
                "on_timeout": "warn"},
               {"name": "load", "end": 0.5, "set": {"/boundaries/lid/F": [0, 0, "-t"], "/laws/0/mu": 0.2, "/insert/feed/active": False},
                "groups": {"top": ["ball", {"type": "half_space", "r": [0, 0, 1], "normal": [0, 0, 1]}]},
                "remove": ["ball", {"type": "box", "low": [0, 0, 0], "high": [0.1, 0.1, 0.1], "note": "a corner"},
                           {"type": "cylinder", "r": [0, 0, 0], "axis": [0, 0, 1], "radius": 0.1, "length": 0.2, "group": "ball"},
                           {"type": "half_space", "r": [0, 0, 1.5], "normal": [0, 0, 1], "group": "ball"}]}]}

# Keys that were renamed. The old name is read with a notice that gives the new one.
RENAMED = {"every": "interval", "frames_every": "frame_interval", "checkpoint_every": "checkpoint_interval"}

MISSING = object()

# Cases that only the program rejects, as (pointer of the changed entry, new value, beginning of the message). The schema
# cannot compare entries with each other, and it accepts laws of any name because a build can add laws.
BY_THE_PROGRAM = [
    ("/domain/high/2", -1.5, "/domain/high/2: high must be above low"),
    ("/laws/0/between/1", "brass", "/laws/0/between/1: no material"),
    ("/orientation", False, "/particles/0/orientation: orientation requires /orientation to be true"),
    ("/particles/0/orientation/0", 0.7, "/particles/0: particle 0: Euler parameters must have the length 1 within 1e-3, got 1.06"),
    ("/laws/0/tangential/law", "sticky", "/laws/0/tangential/law: unknown law"),
    ("/laws/1", MISSING, "/laws: laws: no law is set between two materials that can be in contact, got 'glass' and 'steel'"),
    ("/boundaries/0/material", "wood", "/boundaries/0/material: no material"),
    ("/boundaries/0/material", MISSING, "/boundaries/0: missing key 'material'"),
    ("/boundaries/0/r/2", 0, "/particles/0: particle 0 and boundary 0: must not overlap by more than 5 % of a radius at the start, got 0.05"),
    ("/boundaries/4/v/2", "sine(t)", "/boundaries/4/v/2: unknown function 'sine' in \"sine(t)\" at column 1; did you mean 'sin'?"),
    ("/boundaries/4/v/2", "1/t-1/t+log(t-1)", "/boundaries/4: boundary 'box-x': v is not finite at t = 5e-06 s"),
    ("/particles/0/attached_to", "drum", "/particles/0/attached_to: unknown attached_to"),
    ("/fill/0/attached_to", "lid", "/fill/0/attached_to: attached_to must name a boundary without a mass, got \"lid\""),
    ("/particles/0/replica", 1, "/particles/0/replica: replica must be 0 if a boundary has a mass, as /boundaries/5 has, got 1"),
    ("/boundaries/4/high", [1, 1, -1], "/boundaries/4/high: high must be above low along z"),
    ("/particles/0/material", "wood", "/particles/0/material: no material"),
    ("/particles/0/r/2", 3, "/particles/0: particle 0: is outside the domain along z, got 3"),
    ("/particles/0/r", [0.05, 0.05, 0.3], "/particles/0: particle 0 and particle 3: must not overlap by more than 5 % of a radius at the start, got 0.0"),
    ("/clumps/1/name", "pair", "/clumps/1/name: two clumps have the same name, got \"pair\""),
    ("/clumps/0/material", "wood", "/clumps/0/material: no material"),
    ("/clumps/1/inertia", [1, 1, 3], "/clumps/1/inertia: the principal moments of inertia must be positive"),
    ("/clumps/1/inertia", 0, "/clumps/1/inertia: inertia must be positive, got 0"),
    ("/clumps/0/spheres/0/radius", 3, "/clumps/0: clump 'pair': must not be larger than the domain, 3 m; diameter of the sphere around it"),
    ("/clumps/0/spheres/0/r/1", 2.9, "/particles/1: clump of particle 1: along y, a periodic axis, the domain must be at least 1.1"),
    ("/clumps", MISSING, "/particles/1/clump: clump must name an entry of clumps, which the case does not have, got \"pair\""),
    ("/particles/1/clump", "trio", "/particles/1/clump: unknown clump \"trio\""),
    ("/particles/1/r/2", 2.05, "/particles/1: particle 1: is outside the domain along z, got 2.05"),
    ("/particles/1/orientation/0", 0.7, "/particles/1/orientation: Euler parameters must have the length 1 within 1e-3, got 1.06"),
    ("/particles/1/r", [-0.5, 0, -0.49], "/particles/1: particle 1 and boundary 0: must not overlap by more than 5 %"),
    ("/fill/3/clump", "trio", "/fill/3/clump: unknown clump \"trio\""),
    ("/fill/0/least_radius", 0.06, "/fill/0/least_radius: least_radius must be positive and not greater than radius"),
    ("/fill/0", {"type": "lattice", "low": [0, 0, 0], "high": [1, 1, 1], "radius": 1e-5, "material": "steel"},
     "/fill: 1.08e+14 particles need about "),
    ("/fill/0", {"type": "csv", "file": "none.csv", "material": "steel"}, "/fill/0/file: none.csv: does not exist"),
    ("/fill/1/sizes/least_radius", 0.04, "/fill/1/sizes/least_radius: least_radius must not be above largest_radius"),
    ("/fill/2/sizes/radii", [0.03, 0.02], "/fill/2/sizes/radii/1: radii must be positive and ascending"),
    ("/fill/2/sizes/passing", [0, 0.5], "/fill/2/sizes/passing/1: passing must be 1 at the largest radius"),
    ("/insert/3/clump", "trio", "/insert/3/clump: unknown clump \"trio\""),
    ("/insert/3/radius", 2, "/insert/3/region/high/0: high must be at least a diameter, 4, above low, -0.2, got 0"),
    ("/insert/0/to", 0, "/insert/0/to: to must be after from, 0, got 0"),
    ("/insert/2/name", "feed", "/insert/2/name: two insertions have the same name, got \"feed\""),
    ("/insert/2", {"rate": 1e18, "material": "steel", "radius": 0.01,
                   "region": {"type": "box", "low": [0, 0, 1.1], "high": [0.1, 0.1, 1.2]}}, "/insert: 2e+13 particles need about "),
    ("/insert/2/material", "wood", "/insert/2/material: no material has this name"),
    ("/insert/2/region/high/1", 0.01, "/insert/2/region/high/1: high must be at least a diameter, 0.02, above low, 0, got 0.01"),
    ("/insert/0/region/length", 0.03, "/insert/0/region/length: length must be at least 0.04, so that the largest particle has place"),
    ("/insert/0/region/r/2", 1.9, "/insert/0/region: region must be within the domain along z, got a cylinder of radius 0.3"),
    ("/fill/0/high/1", 0.05, "/fill/0/high/1: high must be at least a diameter, 0.1, above low, 0, got 0.05"),
    ("/step", 0.1, "/step: step must not be above"),
    ("/boundaries/5", {"name": "lid", "type": "plane", "normal": [0, 0, -1], "mass": 2, "material": "steel",
                       "free": [False, False, True, True, False, False]}, "/boundaries/5/free: free rotations need inertia"),
    ("/boundaries/5", {"name": "lid", "type": "plane", "normal": [0, 0, -1], "mass": 2, "material": "steel", "T": [1, 0, 0]},
     "/boundaries/5/T: T needs inertia"),
    ("/boundaries/5/inertia", [1, 1, 3], "/boundaries/5/inertia: the principal moments of inertia must be positive"),
    ("/boundaries/5/inertia", [[2, 1, 0], [0, 2, 0], [0, 0, 2]], "/boundaries/5/inertia: inertia must be symmetric"),
    ("/fields/0/high/0", -1, "/fields/0/high/0: high must be above low, -1, got -1"),
    ("/fields/1/low/2", 2, "/fields/1/high/2: high must be above low, 2, got 1"),
    ("/fields/0/low", [2.5, -1, -1], "/fields/0/low/0: the grid is outside of the domain along x, from -1 to 2, got 2.5"),
    ("/fields/0/low/1", -1.5, "/fields/0/low/1: the grid must be within the domain along y, from -1 to 2, which is periodic, got -1.5"),
    ("/fields/0/high/1", 2.5, "/fields/0/high/1: the grid must be within the domain along y, from -1 to 2, which is periodic, got 2.5"),
    ("/fields/0/cells", [1000, 1000, 1000], "/fields/0/cells: a grid must have at most 1e7 cells, got 1e+09"),
    ("/fields/0/width", 1e-7, "/fields/0/width: width must be at least 1e-6 of the length of the grid along x, 4, got 1e-07"),
    ("/fields/0/width", 4, "/fields/0/width: width must be at most the length of the domain along y, which is periodic, 3, got 4"),
    ("/fields/1/edges", "closed", "/fields/1/edges: edges must be open with the values"),
    ("/fields/0/samples", 50000, "/fields/0/samples: samples must be from 1 to the number of steps of the interval, 40000, got 50000"),
    ("/loads/samples", 50000, "/loads/samples: samples must be from 1 to the number of steps of the interval, 40000, got 50000"),
    ("/boundaries", [], "/loads: loads needs boundaries, got none"),
    ("/fields/1/name", "slice", "/fields/1/name: two fields have the same name, got"),
]
# Cases that both the schema and the program reject
BY_BOTH = [
    ("/hilda_case", 2, "/hilda_case: the version of the format must be 1"),
    ("/hilda_case", MISSING, "/: missing key 'hilda_case'"),
    ("/clumps/0/spheres", [], "/clumps/0/spheres: a clump must have at least one sphere, got none"),
    ("/clumps/0/spheres/1/radius", -1, "/clumps/0/spheres/1/radius: radius must be positive, got -1"),
    ("/clumps/0/spheres/1/radius", MISSING, "/clumps/0/spheres/1: missing key 'radius'"),
    ("/clumps/0/spheres/1/mass", 1, "/clumps/0/spheres/1/mass: unknown key"),
    ("/clumps/0/mass", 1, "/clumps/0/"),
    ("/clumps/1/mass", MISSING, "/clumps/1/inertia: inertia needs mass, got none"),
    ("/clumps/1/mass", 0, "/clumps/1/mass: mass must be positive, got 0"),
    ("/clumps/1/inertia", MISSING, "/clumps/1: inertia is required together with mass"),
    ("/clumps/0/density", 0, "/clumps/0/density: density must be positive, got 0"),
    ("/particles/1/radius", 0.1, "/particles/1/radius: radius must not be given together with clump"),
    ("/particles/1/fixed", True, "/particles/1/fixed: fixed must not be given together with clump"),
    ("/particles/1/attached_to", "floor", "/particles/1/attached_to: attached_to must not be given together with clump"),
    ("/particles/1/scale", 0, "/particles/1/scale: scale must be positive, got 0"),
    ("/particles/0/scale", 2, "/particles/0/scale: scale is only for a particle with clump"),
    ("/fill/3/material", "steel", "/fill/3/material: material must not be given together with clump"),
    ("/fill/0/orientation", [1, 0, 0, 0], "/fill/0/orientation: orientation requires the key clump"),
    ("/steps", 5, "/steps: unknown key \"steps\""),
    ("/name", 5, "/name: name must be a string"),
    ("/note", [], "/note: note must be a string"),
    ("/domain", MISSING, "/: missing key 'domain'"),
    ("/domain/low", MISSING, "/domain: missing key 'low'"),
    ("/domain/high", [1, 1], "/domain/high: high must be a list of 3 numbers"),
    ("/domain/height", 1, "/domain/height: unknown key \"height\""),
    ("/domain/periodic", [True, 1, False], "/domain/periodic/1: periodic must be true or false"),
    ("/gravity", 9.81, "/gravity: gravity must be a list of 3 numbers"),
    ("/gravity/2", None, "/gravity/2: gravity must be a number"),
    ("/step", 0, "/step: step must be positive"),
    ("/step", "1e-5", "/step: step must be a number"),
    ("/step", MISSING, "/: missing key 'step'"),
    ("/end", -1, "/end: end must be positive"),
    ("/interval", 0, "/interval: interval must be positive"),
    ("/frame_interval", 0, "/frame_interval: frame_interval must be positive"),
    ("/orientation", 1, "/orientation: orientation must be true or false"),
    ("/particles/0/orientation", [1, 0, 0], "/particles/0/orientation: orientation must be a list of 4 numbers"),
    ("/particles/0/orientation/2", "x", "/particles/0/orientation/2: orientation must be a number"),
    ("/checkpoint_interval", -1, "/checkpoint_interval: checkpoint_interval must be positive"),
    ("/skin", 0, "/skin: skin must be positive and at most 1 diameter"),
    ("/skin", 1.5, "/skin: skin must be positive and at most 1 diameter"),
    ("/integrator", "euler", "/integrator: unknown integrator"),
    ("/materials", MISSING, "/: a case must have at least one material, got none"),
    ("/materials", {}, "/materials: materials must be a list"),
    ("/materials/0", "glass", "/materials/0: must be an object"),
    ("/materials/0/name", "", "/materials/0/name: name must be a name without control characters"),
    ("/materials/0/name", MISSING, "/materials/0: missing key 'name'"),
    ("/materials/0/density", -2500, "/materials/0/density: density must be positive, got -2500"),
    ("/materials/0/density", 0, "/materials/0/density: density must be positive, got 0"),
    ("/materials/0/E", -7e7, "/materials/0/E: E must be positive"),
    ("/materials/0/nu", 0.5, "/materials/0/nu: nu must be above -1 and below 0.5"),
    ("/materials/0/nu", -1, "/materials/0/nu: nu must be above -1 and below 0.5"),
    ("/materials/0/G", 1, "/materials/0/G: unknown key \"G\""),
    ("/laws/0/between", ["glass"], "/laws/0/between: between must be two names of materials"),
    ("/laws/0/restitution", 1.2, "/laws/0/restitution: restitution must be from 0 to 1"),
    ("/laws/0/restitution", -0.1, "/laws/0/restitution: restitution must be from 0 to 1"),
    ("/laws/0/restitution", MISSING, "/laws/0: missing key 'restitution'"),
    ("/laws/0/mu", -0.3, "/laws/0/mu: mu must not be negative"),
    ("/laws/0/mu", MISSING, "/laws/0: missing key 'mu'"),
    ("/laws/0/mu_s", -0.3, "/laws/0/mu_s: mu_s must not be negative"),
    ("/laws/0/normal/k_n", 1, "/laws/0/normal/k_n: unknown key \"k_n\""),
    ("/laws/0/normal/clamped", 1, "/laws/0/normal/clamped: clamped must be true or false"),
    ("/laws/0/tangential/k_t", 1, "/laws/0/tangential/k_t: unknown key \"k_t\""),
    ("/laws/0/tangential/mu", 1, "/laws/0/tangential/mu: unknown key \"mu\""),
    ("/laws/0/rolling/mu_r", -1, "/laws/0/rolling/mu_r: mu_r must not be negative"),
    ("/laws/0/spin/mu", 1, "/laws/0/spin/mu: unknown key \"mu\""),
    ("/laws/0/cohesion/k", -1, "/laws/0/cohesion/k: k must not be negative"),
    ("/laws/1/normal/k_n", -1, "/laws/1/normal/k_n: k_n must be positive"),
    ("/laws/1/normal/k_n", MISSING, "/laws/1/normal: missing key 'k_n'"),
    ("/laws/1/normal/gamma_n", -1, "/laws/1/normal/gamma_n: gamma_n must not be negative"),
    ("/laws/1/tangential/k_t", MISSING, "/laws/1/tangential: missing key 'k_t'"),
    ("/laws/1/rolling/slow", -1, "/laws/1/rolling/slow: slow must not be negative"),
    ("/laws/1/rolling/after", -1, "/laws/1/rolling/after: after must not be negative"),
    ("/laws/1/cohesion/F_c", -1, "/laws/1/cohesion/F_c: F_c must not be negative"),
    ("/laws/2/rolling/k_r", -1, "/laws/2/rolling/k_r: k_r must not be negative"),
    ("/laws/2/rolling/eta_r", -1, "/laws/2/rolling/eta_r: eta_r must not be negative"),
    ("/laws/2/damping", 1, "/laws/2/damping: unknown key \"damping\""),
    ("/contacts", {}, "/contacts: contacts must have interval, times, or network with the value true"),
    ("/contacts", {"network": False, "times": []}, "/contacts: contacts must have interval, times, or network with the value true"),
    ("/contacts/interval", 0, "/contacts/interval: interval must be positive, got 0"),
    ("/contacts/times/1", -1, "/contacts/times/1: times must not be negative, got -1"),
    ("/contacts/times", 0.1, "/contacts/times: times must be a list"),
    ("/contacts/network", 1, "/contacts/network: network must be true or false"),
    ("/contacts/every", 1, "/contacts/every: unknown key"),
    ("/loads", [], "/loads: must be an object"),
    ("/loads/interval", MISSING, "/loads: missing key 'interval'"),
    ("/loads/samples", 0, "/loads/samples: samples must be from 1"),
    ("/loads/mean", 1, "/loads/mean: unknown key"),
    ("/fields", {}, "/fields: fields must be a list"),
    ("/fields/0/cells", MISSING, "/fields/0: missing key 'cells'"),
    ("/fields/0/cells/2", 0, "/fields/0/cells/2: cells must be integers from 1 to 1e7, got 0"),
    ("/fields/0/cells/0", 2.5, "/fields/0/cells/0: cells must be integers from 1 to 1e7, got 2.5"),
    ("/fields/0/cells", [4, 5], "/fields/0/cells: cells must be a list of 3 numbers"),
    ("/fields/0/width", 0, "/fields/0/width: width must be positive, got 0"),
    ("/fields/0/width", MISSING, "/fields/0: missing key 'width'"),
    ("/fields/0/interval", MISSING, "/fields/0: missing key 'interval'"),
    ("/fields/0/kernel", "gauss", "/fields/0/kernel: unknown kernel"),
    ("/fields/0/name", "a/b", "/fields/0/name: name must consist of letters, digits, - and _"),
    ("/fields/0/samples", 0, "/fields/0/samples: samples must be from 1"),
    ("/fields/0/replica", 70000, "/fields/0/replica: replica must be at most 65535, got 70000"),
    ("/fields/0/values", "means", "/fields/0/values: unknown values"),
    ("/fields/0/every", 1, "/fields/0/every: unknown key"),
    ("/boundaries/0/type", "wall", "/boundaries/0/type: unknown type"),
    ("/boundaries/0/type", MISSING, "/boundaries/0: missing key 'type'"),
    ("/boundaries/0/normal", [0, 0, 0], "/boundaries/0/normal: normal must have a direction"),
    ("/boundaries/0/normal", MISSING, "/boundaries/0: missing key 'normal'"),
    ("/boundaries/0/radius", 1, "/boundaries/0/radius: unknown key \"radius\""),
    ("/boundaries/1/radius", 0, "/boundaries/1/radius: radius must be positive"),
    ("/boundaries/1/inside", 1, "/boundaries/1/inside: inside must be true or false"),
    ("/boundaries/2/half_angle", 1.6, "/boundaries/2/half_angle: half_angle must be between 0 and pi/2"),
    ("/boundaries/3/axis", [0, 0, 1], "/boundaries/3/axis: unknown key \"axis\""),
    ("/boundaries/3/r", "here", "/boundaries/3/r: r must be a list of 3 numbers"),
    ("/boundaries/4/open", ["z"], "/boundaries/4/open/0: open must list some of -x, +x"),
    ("/boundaries/4/open", ["+z", "+z"], "/boundaries/4/open/1: open must list some of -x, +x"),
    ("/boundaries/4/open", ["-x", "+x", "-y", "+y", "-z", "+z"], "/boundaries/4/open: open must not contain all six sides"),
    ("/boundaries/4/low", MISSING, "/boundaries/4: missing key 'low'"),
    ("/boundaries/4/omega", [0, 0, 1], "/boundaries/4/omega: unknown key \"omega\""),
    ("/boundaries/4/r/2", "t", "/boundaries/4/v: v must be 0 or not be given if r is a formula"),
    ("/boundaries/0/name", "a,b", "/boundaries/0/name: name must not contain commas and quotes"),
    ("/boundaries/0", {"type": "body", "part_of": "lid", "material": "steel"},
     "/boundaries/0/part_of: part_of must not be given for the type body"),
    ("/boundaries/5/v", [0, 0, 1], "/boundaries/5/v: v must be 0 or not be given if r is a formula, got [0, 0, 1]"),
    ("/boundaries/5/r", ["t", "t"], "/boundaries/5/r: r must be three numbers or expressions in t"),
    ("/boundaries/5/omega", [0, 0, "t"], "/boundaries/5/omega: omega must be three numbers if the boundary rotates freely about all axes"),
    ("/boundaries/5/mass", -1, "/boundaries/5/mass: mass must be positive"),
    ("/boundaries/5/mass", MISSING, "/boundaries/5/inertia: inertia is only for a boundary with a mass"),
    ("/boundaries/5/inertia", -1, "/boundaries/5/inertia: inertia must not be negative"),
    ("/boundaries/5/free", True, "/boundaries/5/free: free must be a list of 3 or 6 values, each true or false"),
    ("/boundaries/5/inertia", [[1, 0, 0], [0, 1, 0]], "/boundaries/5/inertia: inertia must be one number, three numbers or three rows"),
    ("/boundaries/5/T", [0, "x"], "/boundaries/5/T: T must be three numbers or expressions in t"),
    ("/boundaries/5/F", [0, 0, None], "/boundaries/5/F/2: F must be a number"),
    ("/particles/0/force", 1, "/particles/0/force: force must be a list of 3 numbers"),
    ("/particles/0/replica", -1, "/particles/0/replica: replica must be an integer from 0 to 2^53"),
    ("/particles/0/replica", 65536, "/particles/0/replica: replica must be at most 65535"),
    ("/particles/0/radius", -0.1, "/particles/0/radius: radius must be positive"),
    ("/particles/0/radius", None, "/particles/0/radius: radius must be a number"),
    ("/particles/0/r", [0.5, None, 0.5], "/particles/0/r/1: r must be a number"),
    ("/particles/0/fixed", "no", "/particles/0/fixed: fixed must be true or false"),
    ("/particles/0/mass", 1, "/particles/0/mass: unknown key \"mass\""),
    ("/fill/0/type", "heap", "/fill/0/type: unknown type"),
    ("/fill/0", {"type": "csv", "material": "steel"}, "/fill/0: missing key 'file'"),
    ("/fill/0/file", "a.csv", "/fill/0/file: unknown key \"file\""),
    ("/fill/0/spacing", 0.9, "/fill/0/spacing: spacing must be at least 1 diameter"),
    ("/fill/0/jitter", 2, "/fill/0/jitter: jitter must be from 0 to 1"),
    ("/fill/0/count", -1, "/fill/0/count: count must be an integer from 0 to 2^53"),
    ("/fill/0/count", 1.5, "/fill/0/count: count must be an integer from 0 to 2^53"),
    ("/fill/0/random_v", -1, "/fill/0/random_v: random_v must not be negative"),
    ("/fill/0/sizes", {"type": "uniform", "least_radius": 0.01, "largest_radius": 0.02},
     "/fill/0/radius: radius must not be given together with sizes"),
    ("/fill/1/sizes", MISSING, "/fill/1: missing key 'radius'"),
    ("/fill/1/sizes/type", "gauss", "/fill/1/sizes/type: unknown type"),
    ("/fill/1/sizes/by", "volume", "/fill/1/sizes/by: unknown by \"volume\""),
    ("/fill/1/sizes/median", MISSING, "/fill/1/sizes: missing key 'median'"),
    ("/fill/1/sizes/median", 0, "/fill/1/sizes/median: median must be positive"),
    ("/fill/1/sizes/deviation", 4, "/fill/1/sizes/deviation: deviation must be at most 3"),
    ("/fill/1/sizes/mean", 1, "/fill/1/sizes/mean: unknown key \"mean\""),
    ("/fill/2/sizes/passing", MISSING, "/fill/2/sizes/radii: a table must have either fractions or passing, got none"),
    ("/fill/2/sizes/fractions", [1, 1], "/fill/2/sizes/passing: a table must have either fractions or passing, got both"),
    ("/fill/2/sizes/radii", [], "/fill/2/sizes/radii: radii must have a number at least"),
    ("/fill/2/sizes/radii", [0, 1], "/fill/2/sizes/radii/0: radii must be positive and ascending"),
    ("/insert/3/material", "steel", "/insert/3/material: material must not be given together with clump"),
    ("/insert/3/clump", MISSING, "/insert/3/orientation: orientation requires the key clump"),
    ("/insert/0/mass_rate", 1, "/insert/0/mass_rate: mass_rate must not be given together with rate"),
    ("/insert/2/count", MISSING, "/insert/2: one of the keys rate, mass_rate and count is required"),
    ("/insert/2/count", 0, "/insert/2/count: count must be positive"),
    ("/insert/2/to", 1, "/insert/2/to: to must be given together with rate or mass_rate only"),
    ("/insert/0/from", -1, "/insert/0/from: from must not be negative"),
    ("/insert/0/interval", 0, "/insert/0/interval: interval must be positive"),
    ("/insert/0/on_overlap", "delete", "/insert/0/on_overlap: unknown on_overlap"),
    ("/insert/0/tries", 100, "/insert/0/tries: tries must be at least 200"),
    ("/stages/1/remove/1/low", MISSING, "/stages/1/remove/1: missing key 'low'"),
    ("/stages/1/remove/1/group", "", "/stages/1/remove/1/group: group must be a name without control characters, got \"\""),
    ("/stages/1/remove/2/length", 0, "/stages/1/remove/2/length: length must be positive, got 0"),
    ("/stages/1/remove/3/radius", 0.1, "/stages/1/remove/3/radius: unknown key \"radius\""),
    ("/stages/1/remove/3/type", "plane", "/stages/1/remove/3/type: unknown type \"plane\""),
    ("/stages/1/remove/0", 3, "/stages/1/remove/0: remove must list names of groups and regions, got 3"),
    ("/insert/0/region", MISSING, "/insert/0: missing key 'region'"),
    ("/insert/0/region/type", "ball", "/insert/0/region/type: unknown type"),
    ("/insert/1/region/axis", [0, 0, 1], "/insert/1/region/axis: unknown key \"axis\""),
    ("/insert/2/speed", 1, "/insert/2/speed: unknown key \"speed\""),
    ("/insert/2/radius", MISSING, "/insert/2: missing key 'radius'"),
    ("/fill/0/number", 1, "/fill/0/number: unknown key \"number\""),
]


def changed(case, pointer, value):
    """A copy of the case with one entry set or removed"""
    case = copy.deepcopy(case)
    *path, last = pointer.split("/")[1:]
    at = case
    for key in path:
        at = at[int(key) if isinstance(at, list) else key]
    last = int(last) if isinstance(at, list) else last
    if value is MISSING:
        del at[last]
    else:
        at[last] = value
    return case


def faults_of_commands(schema):
    """The commands schema and laws: the program prints the schema of this file, and the laws that it contains"""
    def output_of(*arguments):
        done = subprocess.run([sys.argv[1], *arguments], capture_output=True, text=True)
        return done.returncode, done.stdout, done.stderr

    code, out, err = output_of("schema")
    faults = []
    if code != 0 or err or json.loads(out) != schema:
        faults.append(f"schema: exit code {code}, or not the schema of granular/case.schema.json: {err}")
    code, out, err = output_of("laws")
    found = re.findall(r"^(\w+) +([\w-]+)  ", out, re.MULTILINE)
    kinds = ("normal", "tangential", "rolling", "spin", "cohesion")
    definitions = [name for name in schema["$defs"] if name.split("_")[0] in kinds and not name.endswith("_law")]
    if code != 0 or err or sorted("_".join(law).replace("-", "_") for law in found) != sorted(definitions):
        faults.append(f"laws: exit code {code}, {found} and not {definitions}: {err}")
    defaults = re.findall(r"^(\w+) +([\w-]+)  (?:(?!^\w).)*The default\.", re.sub(r"\n +", " ", out), re.MULTILINE)
    if defaults != [(kind, "hertz" if kind == "normal" else "none") for kind in kinds]:
        faults.append(f"laws: the defaults are {defaults}")
    for command in "schema", "laws":
        code, out, err = output_of(command, "--seed", "1")
        if code != 2 or out or f"--seed: is valid for cases only, but {command} is a command" not in err:
            faults.append(f"{command} --seed: exit code {code}: {err}")
    return faults


def main():
    with open(root / "granular" / "case.schema.json", encoding="utf-8") as file:
        schema = json.load(file)
    validator_class = jsonschema.validators.validator_for(schema)
    validator_class.check_schema(schema)
    validator = validator_class(schema)
    faults = faults_of_text(schema)

    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)

        def run(case, quiet=True):
            (folder / "case.json").write_text(json.dumps(case))
            done = subprocess.run([sys.argv[1], "case.json", "--threads", "1", "--output", "out"] + ["--quiet"] * quiet,
                                  cwd=folder, capture_output=True, text=True)
            return done.returncode, done.stderr

        for pointer, value, message in BY_BOTH + BY_THE_PROGRAM:
            case = changed(EVERYTHING, pointer, value)
            code, err = run(case)
            place, _, rest = message.partition(":")
            expected = re.escape(message)
            if message.startswith("/"):
                expected = r"case.json:\d+:\d+ \(" + re.escape(place) + r"[^ ]*\)" + (re.escape(":" + rest) if rest else "")
            if code != 3 or not re.search(expected, err) or "hilda: error: case.json:" not in err:
                faults.append(f"{pointer}: the program exited with {code}, not with 3 and '{message}': {err}")
            if (folder / "out").exists():
                faults.append(f"{pointer}: the program wrote files")
            by_both = (pointer, value, message) in BY_BOTH
            if validator.is_valid(case) == by_both:
                faults.append(f"{pointer}: {value}: {'accepted' if by_both else 'rejected'} by the schema")

        examples = sorted((root / "granular" / "cases").glob("*.json"))
        valid = [EVERYTHING] + [json.loads(file.read_text()) for file in examples]
        for case in valid:
            faults += [f"{case['name']}: {e.json_path}: {e.message[:200]}" for e in validator.iter_errors(case)]
        code, err = run(EVERYTHING)
        if code != 0:
            faults.append(f"the case with every key: the program exited with {code}: {err}")

        shutil.rmtree(folder / "out", ignore_errors=True)
        old_names = {**EVERYTHING, **{old: EVERYTHING[new] for old, new in RENAMED.items()}}
        for new in RENAMED.values():
            del old_names[new]
        if not validator.is_valid(old_names):
            faults.append("the schema rejects the old names of renamed keys")
        code, err = run(old_names, quiet=False)
        if code != 0:
            faults.append(f"old names of renamed keys: the program exited with {code}: {err}")
        for old, new in RENAMED.items():
            if f"/{old}" not in err or new not in err:
                faults.append(f"/{old}: the program prints no notice with the new name {new}: {err}")

    faults += faults_of_commands(schema)
    for fault in faults:
        print(fault)
    print(f"{len(valid)} cases accepted, {len(BY_BOTH)} rejected by both, {len(BY_THE_PROGRAM)} by the program only; "
          f"{len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
