# SPDX-License-Identifier: GPL-3.0-or-later
"""Import of URDF and MJCF files: the motion against that of MuJoCo, structure, and files that are refused.

    HILDA_PROGRAM=build/release/hilda MUJOCO_RUN=build/release/tests/mujoco_run python3 tests/importing/import_test.py
"""
import csv
import itertools
import json
import os
import subprocess
import tempfile
import time
import unittest

import numpy as np

HILDA = os.path.abspath(os.environ["HILDA_PROGRAM"])
MUJOCO = os.environ.get("MUJOCO_RUN", "")
HERE = os.path.dirname(os.path.abspath(__file__))
INERTIA = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'


def run(*words, expected=0):
    done = subprocess.run(words, capture_output=True, text=True)
    assert done.returncode == expected, (words, done.returncode, done.stdout, done.stderr)
    return done.stdout + done.stderr


class Import(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.root = self.temporary.name

    def tearDown(self):
        self.temporary.cleanup()

    def path(self, name):
        return os.path.join(self.root, name)

    def imported(self, file, *options):
        """The model of a file, and what was printed"""
        text = run(HILDA, "import", file, "--output", self.path("model.json"), "--force", *options)
        with open(self.path("model.json"), encoding="utf-8") as model:
            return json.load(model), text

    def written(self, text, name="model.xml"):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)
        return self.path(name)

    def refused(self, text, expected, name="model.xml", *options):
        file = self.written(text, name)
        said = run(HILDA, "import", file, "--output", self.path("refused.json"), *options, expected=3)
        self.assertRegex(said, expected)
        self.assertEqual(said.count("\n"), 1, said)
        self.assertIn(file, said)
        self.assertFalse(os.path.exists(self.path("refused.json")))

    FLOATING = '<joint name="j{0}" type="floating"><parent link="world"/><child link="{0}"/><origin xyz="{1}"/></joint>'

    def collisions(self, *geometries, origin="0 0 0"):
        return "".join(f'<collision><origin xyz="{origin}"/><geometry>{g}</geometry></collision>' for g in geometries)

    def last_row(self, folder="out"):
        with open(self.path(folder + "/trajectory.csv"), newline="", encoding="utf-8") as table:
            return {name: float(value) for name, value in list(csv.DictReader(table))[-1].items()}

    def checked_and_run(self, end="0.5"):
        """The last row of a run of the imported model, which passes the check"""
        run(HILDA, "check", self.path("model.json"))
        run(HILDA, "run", self.path("model.json"), "--end", end, "--output", self.path("out"), "--force")
        return self.last_row()

    def test_contacts_of_urdf(self):
        """A box rests on the floor, and a second one falls on it and rests as well."""
        box = self.collisions('<box size="0.2 0.2 0.1"/>')
        text = ("<robot name='r'><link name='world'/>" + "".join(f"<link name='{n}'>{INERTIA}{box}</link>" for n in "ab") +
                self.FLOATING.format("a", "0 0 0.05") + self.FLOATING.format("b", "0.05 0 0.17") + "</robot>")
        model, said = self.imported(self.written(text), "--contacts")
        self.assertIn("2 bodies with 12 degrees of freedom, 3 rigid contacts", said)
        self.assertNotIn("warning", said)
        of_boxes, of_floor = model["contacts"]
        self.assertEqual((of_boxes["body_i"], of_boxes["body_j"]), ("a", "b"))
        self.assertEqual((of_floor["body_i"], of_floor["body_j"], of_floor["surface_j"]), (["a", "b"], "ground", {"type": "plane"}))
        for contact in model["contacts"]:
            self.assertEqual(contact["surface_i"], {"type": "box", "lengths": [0.2, 0.2, 0.1]})
            self.assertEqual((contact["normal"], contact["friction"]), ({"type": "dvi"}, {"law": "coulomb", "mu_s": 0.5}))
        row = self.checked_and_run()
        for body, z in (("a", 0.05), ("b", 0.15)):
            self.assertAlmostEqual(row[body + ".rz"], z, delta=1e-9)
            self.assertAlmostEqual(row[body + ".vz"], 0, delta=1e-9)
        # without the option
        model, said = self.imported(self.written(text))
        self.assertIn("not imported: contacts between collision geometries, which --contacts imports", said)
        self.assertNotIn("contacts", model)

    def test_contacts_of_neighbours_and_overlaps(self):
        """A chain of four links: neighbours have no contact, and those that overlap at the start have none, with a warning."""
        ball = self.collisions('<sphere radius="0.06"/>', origin="0 0 1")
        text = self.robot(4, ball).replace('<link name="link_0"/>', '<link name="link_0">' + ball + "</link>")
        model, said = self.imported(self.written(text, "arm.urdf"), "--contacts")
        overlaps = [line for line in said.splitlines() if "overlap" in line]
        self.assertEqual(overlaps, [])  # at a distance of 0.2 m, twice that of neighbours
        single = [c for c in model["contacts"] if c["body_j"] != "ground" and c["body_i"] != "ground"]
        self.assertEqual([(c["body_i"], c["body_j"]) for c in single],
                         [("link_1", "link_3"), ("link_1", "link_4"), ("link_2", "link_4")])
        fixed = [c for c in model["contacts"] if c.get("surface_i", {}).get("position") == [0, 0, 1]]
        self.assertEqual([c["body_j"] for c in fixed if c["body_i"] == "ground"], ["link_2", "link_3", "link_4"])
        model, said = self.imported(self.written(text.replace("0.06", "0.11"), "arm.urdf"), "--contacts")
        self.assertIn("not imported: contact of sphere of link 'link_1' with sphere of link 'link_3', which overlap by 0.02 m at the start", said)
        self.assertEqual(sum("overlap" in line for line in said.splitlines()), 3)
        self.assertIn("contact of sphere of link 'link_1' with sphere of link 'link_3'", model["note"])
        run(HILDA, "check", self.path("model.json"))

    def test_contacts_that_are_left_out(self):
        with open(self.path("stone.obj"), "w", encoding="utf-8") as file:
            for k in range(8):
                file.write(f"v {k & 1} {k >> 1 & 1} {k >> 2}\n")
            file.write("v 0.5 0.5 0.5\nf 1 2 3\nf 4 5 6\nf 7 8 9\n")  # the last vertex is inside
        with open(self.path("plate.obj"), "w", encoding="utf-8") as file:
            file.write("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        shapes = self.collisions('<cylinder radius="0.1" length="0.2"/>', '<mesh filename="package://a/b.stl"/>', '<mesh filename="none.stl"/>',
                                 '<mesh filename="plate.obj"/>', '<mesh filename="stone.obj" scale="0.1 0.1 0.2"/>')
        text = (f"<robot name='r'><link name='world'/><link name='a'>{INERTIA}{shapes}</link>" + self.FLOATING.format("a", "0 0 0") + "</robot>")
        model, said = self.imported(self.written(text), "--contacts")
        for expected in ("height of body 'world', which is raised by 0.1 m with all others", "mesh package://a/b.stl of link 'a': the place of a package is not known",
                         "mesh none.stl of link 'a': .*none.stl", "mesh plate.obj of link 'a': "):
            self.assertRegex(said, "not imported: " + expected)
        self.assertEqual(said.count("warning"), 4)
        surfaces = [contact["surface_i"] for contact in model["contacts"]]
        self.assertEqual(sorted(surface["type"] for surface in surfaces), ["convex", "disk", "disk"])
        surface = next(surface for surface in surfaces if surface["type"] == "convex")
        self.assertEqual(len(surface["vertices"]), 8)
        self.assertIn([0.1, 0.1, 0.2], surface["vertices"])
        self.assertAlmostEqual(self.checked_and_run()["a.rz"], 0.1, delta=1e-9)

    def test_contacts_of_wheels(self):
        """The rims of a cylinder are its contact on the floor: a cart whose wheels stand at the start rolls as a rigid body does."""
        wheel = (f'<link name="{{0}}">{INERTIA}<collision><origin rpy="1.5707963267948966 0 0"/><geometry><cylinder radius="0.1" length="0.04"/></geometry>'
                 '</collision></link><joint name="axle_{0}" type="continuous"><parent link="cart"/><child link="{0}"/><origin xyz="{1} {2} -0.1"/>'
                 '<axis xyz="0 1 0"/></joint>')
        text = (f"<robot name='r'><link name='cart'>{INERTIA}{self.collisions('<box size=%s/>')}</link>" % '"0.4 0.2 0.1"' +
                "".join(wheel.format(name, x, y) for name, x, y in (("fl", 0.2, 0.15), ("fr", 0.2, -0.15), ("rl", -0.2, 0.15), ("rr", -0.2, -0.15))) +
                "</robot>")
        model, said = self.imported(self.written(text), "--contacts", "--base", "free")
        self.assertIn("raised by 0.2 m", said)
        self.assertRegex(said, "contact of cylinder of link 'fl' with cylinder of link 'fr': a disk can be paired with a plane only.*; and 5 other pairs")
        disks = [c for c in model["contacts"] if c["surface_i"]["type"] == "disk"]
        self.assertEqual([(c["body_i"], c["body_j"]) for c in disks], [(["fl", "fr", "rl", "rr"], "ground")] * 2)
        model["gravity"] = [1, 0, -9.81]
        self.written(json.dumps(model), "model.json")
        row = self.checked_and_run("1")
        # five masses of 1 kg and four moments of inertia of 1 kg m²: a = 5 g_x / (5 + 4/R²), R = 0.1 m
        self.assertAlmostEqual(row["cart.vx"], 5 / 405, delta=1e-8)
        self.assertAlmostEqual(row["cart.rz"], 0.2, delta=1e-8)

    def test_contacts_of_a_standing_cylinder(self):
        shape = self.collisions('<cylinder radius="0.1" length="0.2"/>')
        text = f"<robot name='r'><link name='a'>{INERTIA}{shape}</link></robot>"
        model, said = self.imported(self.written(text), "--contacts", "--base", "free")
        self.assertIn("raised by 0.1 m", said)
        self.assertEqual(said.count("warning"), 1)
        self.assertEqual([c["surface_i"]["type"] for c in model["contacts"]], ["disk", "disk"])
        row = self.checked_and_run("1")
        self.assertAlmostEqual(row["a.rz"], 0.1, delta=1e-9)
        self.assertAlmostEqual(row["a.vz"], 0, delta=1e-10)

    def test_base_is_raised(self):
        """A free base whose geometry is below the floor is raised onto it."""
        box = self.collisions('<box size="0.2 0.2 0.1"/>')
        text = f"<robot name='r'><link name='a'>{INERTIA}{box}</link></robot>"
        model, said = self.imported(self.written(text), "--contacts", "--base", "free")
        self.assertIn("height of body 'a', which is raised by 0.05 m with all others: geometries were below the floor z = 0", said)
        self.assertEqual(model["bodies"][0]["r"], [0, 0, 0.05])
        self.assertAlmostEqual(self.checked_and_run()["a.rz"], 0.05, delta=1e-9)

    def test_contacts_of_mjcf(self):
        def body(name, z, geoms, joint="<freejoint/>"):
            return f'<body name="{name}" pos="0 0 {z}">{joint}{geoms}</body>'
        box = '<geom type="box" size="0.05 0.05 0.05" friction="0.3 0 0"/>'
        capsule = '<geom type="capsule" size="0.02 0.05" euler="0 90 0" {}/>'
        floor = '<geom name="floor" type="plane" size="1 1 1" friction="0.8 0.1 0.1"/>'
        text = ("<mujoco><worldbody>" + floor + body("a", 0.05, box) + body("b", 0.15, box) + body("c", 0.22, capsule.format('condim="1"')) +
                "</worldbody>{}</mujoco>")
        model, said = self.imported(self.written(text.format("")), "--contacts")
        self.assertIn("6 rigid contacts", said)
        mu = {(str(c["body_i"]), str(c["body_j"])): c.get("friction", {}).get("mu_s") for c in model["contacts"]}
        self.assertEqual(mu, {("ground", "['a', 'b']"): 0.8, ("ground", "c"): 1, ("a", "b"): 0.3, ("['a', 'b']", "c"): 1})
        row = self.checked_and_run()
        for name, z in (("a", 0.05), ("b", 0.15), ("c", 0.22)):
            self.assertAlmostEqual(row[name + ".rz"], z, delta=1e-6)
        # masks, exclusions, priority and the flag
        model, said = self.imported(self.written(text.format('<contact><exclude body1="a" body2="b"/></contact>')), "--contacts")
        self.assertIn("5 rigid contacts", said)
        model, said = self.imported(self.written(text.format("").replace(box, box.replace("/>", ' contype="0" conaffinity="0"/>'))), "--contacts")
        self.assertEqual([(c["body_i"], c["body_j"]) for c in model["contacts"]], [("ground", "c")])
        model, said = self.imported(self.written(text.format("").replace("0.8 0.1 0.1", '0.2 0.1 0.1" priority="1')), "--contacts")
        self.assertEqual(model["contacts"][0]["friction"]["mu_s"], 0.2)
        flag = text.format("").replace("<worldbody>", '<option><flag contact="disable"/></option><worldbody>')
        self.assertEqual(self.imported(self.written(flag), "--contacts")[0]["contacts"], [])
        frictionless = text.format("").replace(floor, floor.replace("/>", ' condim="1"/>'))
        model, said = self.imported(self.written(frictionless), "--contacts")
        self.assertNotIn("friction", next(c for c in model["contacts"] if c["body_j"] == "c" and c["body_i"] == "ground"))
        # what has no detector
        text = text.replace(capsule.format('condim="1"'), '<geom name="egg" type="ellipsoid" size="0.02 0.03 0.02"/><geom name="can" type="cylinder" size="0.1 0.1"/>')
        model, said = self.imported(self.written(text.format("")), "--contacts")
        self.assertEqual([c["body_i"] for c in model["contacts"] if c["surface_i"]["type"] == "disk" or c["surface_j"]["type"] == "disk"], ["ground"] * 2)
        self.assertRegex(said, "contact of geom 'geom_1' of body 'a' with geom 'can' of body 'c': a box can be paired with .*, got box and disk; and 1 other pair")
        self.assertEqual(said.count("box and disk"), 1)
        self.assertEqual([c["body_j"] for c in model["contacts"] if c["surface_j"]["type"] == "ellipsoid"], ["c", "c"])
        run(HILDA, "check", self.path("model.json"))

    @unittest.skipUnless(MUJOCO, "built without MuJoCo")
    def test_motion_is_that_of_mujoco(self):
        step, end = "2e-4", "1"
        for file, most in (("arm.urdf", 1e-8), ("crane.xml", 1e-6), ("swing.xml", 1e-11)):
            self.imported(os.path.join(HERE, file))
            run(HILDA, "run", self.path("model.json"), "--integrator", "rA-rkmk-4", "--step", step, "--end", end,
                "--output", self.path("out"), "--force")
            with open(self.path("out/trajectory.csv"), newline="", encoding="utf-8") as table:
                rows = list(csv.DictReader(table))

            def orientation(row, body):
                return np.array([[float(row[f"{body}.A{i}{j}"]) for j in "123"] for i in "123"])
            lines = run(MUJOCO, os.path.join(HERE, file), step, end).splitlines()
            self.assertGreaterEqual(len(lines), 3)
            moved = 0.0
            for line in lines:
                body, *values = line.split()
                values = np.array(values, dtype=float)
                r = np.array([float(rows[-1][f"{body}.r{c}"]) for c in "xyz"])
                start = np.array([float(rows[0][f"{body}.r{c}"]) for c in "xyz"])
                turn = orientation(rows[-1], body) @ orientation(rows[0], body).T
                with self.subTest(file=file, body=body):
                    self.assertLess(abs(r - values[:3]).max(), most)
                    self.assertLess(abs(turn - values[3:].reshape(3, 3)).max(), most)
                moved = max(moved, np.linalg.norm(r - start))
            self.assertGreater(moved, 0.05)

    def test_structure(self):
        model, text = self.imported(os.path.join(HERE, "arm.urdf"))
        self.assertIn("not imported: limits of joint 'rail'", text)
        self.assertIn("3 bodies with 3 degrees of freedom", text)
        self.assertEqual([c["type"] for c in model["constraints"]], ["revolute", "revolute", "translational"])
        masses = {body["name"]: body["mass"] for body in model["bodies"]}
        self.assertEqual(masses, {"upper": 1.2, "lower": 0.8 + 0.3, "slider": 0.2})  # base is fixed, tool is welded
        self.assertEqual(model["forces"][0]["damping"], 0.05)
        floating, text = self.imported(os.path.join(HERE, "arm.urdf"), "--base", "free")
        self.assertIn("base", [body["name"] for body in floating["bodies"]])
        self.assertIn("9 degrees", text)
        model, _ = self.imported(os.path.join(HERE, "crane.xml"))
        self.assertEqual([c["type"] for c in model["constraints"]], ["translational", "universal", "spherical"])
        self.assertEqual(model["gravity"], [0.3, 0, -9.81])
        model, _ = self.imported(os.path.join(HERE, "swing.xml"))
        self.assertEqual([c["type"] for c in model["constraints"]], ["revolute", "revolute", "cylindrical"])
        self.assertAlmostEqual(model["forces"][1]["free_angle"], 0.3)  # springref - ref

    def test_export_and_import(self):
        """A model that was exported and imported again moves as before."""
        def last_row(model, folder):
            run(HILDA, "run", model, "--integrator", "rA-dop853", "--rtol", "1e-11", "--end", "1", "--output", self.path(folder))
            with open(self.path(folder + "/trajectory.csv"), newline="", encoding="utf-8") as table:
                return {name: float(value) for name, value in list(csv.DictReader(table))[-1].items()}
        self.imported(os.path.join(HERE, "arm.urdf"))
        os.rename(self.path("model.json"), self.path("first.json"))
        text = run(HILDA, "export", self.path("first.json"), "--output", self.path("again.urdf"))
        self.assertIn("not exported: force 'rail'", text)  # the damper of a slide
        model, _ = self.imported(os.path.join(HERE, "arm.urdf"))
        model["forces"] = model["forces"][:1]
        self.written(json.dumps(model), "first.json")
        self.imported(self.path("again.urdf"))
        first, again = last_row(self.path("first.json"), "one"), last_row(self.path("model.json"), "two")
        for name, value in first.items():
            if ".r" in name or ".A" in name:
                self.assertAlmostEqual(again[name], value, delta=1e-8, msg=name)
        for model, expected in (("n_pendulum_2", "CD has no counterpart"), ("slider_crank", "no counterpart")):
            self.assertRegex(run(HILDA, "export", model, "--output", self.path("x.urdf"), expected=3), expected)
        loop = {"hilda_model": 1, "name": "loop", "bodies": [
            {"name": n, "mass": 1, "inertia": [1, 1, 1], "r": [x, 0, 0]} for n, x in (("a", 1), ("b", 2))],
            "constraints": [{"name": f"{i}-{j}", "type": "revolute", "body_i": i, "body_j": j, "axis_bar_i": [1, 0, 0],
                             "axis_bar_j": [1, 0, 0], "s_bar_p_i": p, "s_bar_q_j": q}
                            for i, j, p, q in (("ground", "a", [0, 0, 0], [-1, 0, 0]), ("b", "a", [-1, 0, 0], [0, 0, 0]),
                                               ("ground", "b", [0, 0, 0], [-2, 0, 0]))]}
        said = run(HILDA, "export", self.written(json.dumps(loop), "loop.json"), "--output", self.path("x.urdf"), expected=3)
        self.assertRegex(said, "constraint '.*' closes a loop; URDF files are trees")

    def test_attitudes(self):
        """Export and import give every attitude again: the permutations of the axes, which have pitches of 90 degrees, and others."""
        attitudes = []
        for order in itertools.permutations(range(3)):
            for signs in itertools.product((1, -1), repeat=3):
                A = np.zeros((3, 3))
                A[range(3), order] = signs
                attitudes.append(A)
        random = np.random.default_rng(3)
        attitudes += [np.linalg.qr(random.normal(size=(3, 3)))[0] for _ in range(40)]
        attitudes = [A for A in attitudes if np.linalg.det(A) > 0]
        for tilt in (1e-3, 1e-8, 1e-12, 1e-15):  # beside a pitch of 90 degrees
            c, s = np.cos(tilt), np.sin(tilt)
            attitudes.append(np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]]) @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]))
        model = {"hilda_model": 1, "name": "turned", "bodies": [
            {"name": f"b{k}", "mass": 1, "inertia": [1, 2, 2.5], "r": [k, 0, 0], "A": A.tolist()} for k, A in enumerate(attitudes)]}
        run(HILDA, "export", self.written(json.dumps(model), "turned.json"), "--output", self.path("turned.urdf"))
        again, _ = self.imported(self.path("turned.urdf"))
        found = {body["name"]: np.array(body.get("A", np.eye(3))) for body in again["bodies"]}
        self.assertEqual(len(found), len(attitudes))
        for k, A in enumerate(attitudes):
            self.assertLess(np.abs(found[f"b{k}"] - A).max(), 2e-15, A)

    def test_loop(self):
        model, text = self.imported(self.written('''<mujoco><worldbody>
            <body name="a" pos="1 0 0"><joint axis="0 1 0"/><geom type="box" size="0.5 0.05 0.05" pos="0.5 0 0"/>
              <body name="b" pos="1 0 0"><joint axis="0 1 0"/><geom type="box" size="0.5 0.05 0.05" pos="0.5 0 0"/></body></body>
            <body name="c" pos="3 0 1"><joint axis="0 1 0"/><geom type="box" size="0.05 0.05 0.5" pos="0 0 -0.5"/></body>
            </worldbody><equality><connect body1="b" body2="c" anchor="1 0 0"/></equality></mujoco>'''))
        self.assertEqual(model["constraints"][-1]["type"], "spherical")
        self.assertIn("3 bodies with 1 degree of freedom", text)
        self.assertIn("not imported: contacts between geoms", text)

    def test_welds(self):
        """A pose of a weld that is not that of qpos0 is named."""
        text = """<mujoco><worldbody>
            <body name="a" pos="1 0 0" euler="0 0 30"><freejoint/><geom size="0.1"/></body>
            <body name="b" pos="2 0 0.5" euler="40 0 0"><freejoint/><geom size="0.1"/></body></worldbody>
            <equality><weld name="w" body1="a" body2="b"/></equality></mujoco>"""
        model, said = self.imported(self.written(text))
        self.assertNotIn("relpose", said)
        self.assertIn("2 bodies with 6 degrees of freedom", said)
        _, said = self.imported(self.written(text.replace('body2="b"', 'body2="b" relpose="1 0 0 1 0 0 0"')))
        self.assertRegex(said, "relpose of equality 'w', from which qpos0 differs by 0.7[0-9]* m and 0.8[0-9]* rad")

    def test_names(self):
        """A joint and an equality of one name; a body that is named like the root of a URDF file."""
        model, _ = self.imported(self.written("""<mujoco><worldbody>
            <body name="a"><joint name="pin" axis="0 1 0"/><geom size="0.1" pos="1 0 0"/></body>
            <body name="b" pos="1 0 0"><freejoint/><geom size="0.1"/></body></worldbody>
            <equality><connect name="pin" body1="a" body2="b" anchor="1 0 0"/></equality></mujoco>"""))
        self.assertEqual([c["name"] for c in model["constraints"]], ["pin", "pin_2"])
        inertia = {"mass": 1, "inertia": [1, 1, 1]}
        model = {"hilda_model": 1, "name": "odd", "bodies": [
            {"name": "world", "r": [1, 0, 0], **inertia}, {"name": "a", "r": [2, 0, 0], **inertia}],
            "constraints": [{"name": "a_free", "type": "revolute", "body_i": "ground", "body_j": "world",
                             "axis_bar_i": [0, 1, 0], "axis_bar_j": [0, 1, 0], "s_bar_q_j": [-1, 0, 0]}]}
        run(HILDA, "export", self.written(json.dumps(model), "odd.json"), "--output", self.path("odd.urdf"))
        again, said = self.imported(self.path("odd.urdf"))
        self.assertEqual([body["name"] for body in again["bodies"]], ["world", "a"])
        self.assertIn("7 degrees of freedom", said)

    def test_free_base(self):
        text = """<mujoco><worldbody><body name="turntable"><joint axis="0 0 1"/><geom size="0.1" pos="1 0 0"/></body>
            <body name="base" pos="0 0 1"><geom size="0.1"/></body></worldbody></mujoco>"""
        _, said = self.imported(self.written(text), "--base", "free")
        self.assertIn("2 bodies with 7 degrees of freedom", said)
        one = text.replace('<geom size="0.1"/></body>', '<joint/><geom size="0.1"/></body>')
        self.assertIn("--base free: each body of the world has a joint",
                      run(HILDA, "import", self.written(one), "--base", "free", expected=3))
        two = text.replace('<joint axis="0 0 1"/>', "")
        self.assertIn("--base free: the bodies 'turntable' and 'base' of the world have no joint",
                      run(HILDA, "import", self.written(two), "--base", "free", expected=3))

    def test_flags(self):
        text = """<mujoco><option><flag passive="disable" equality="disable"/></option><worldbody>
            <body name="a"><joint axis="0 1 0" stiffness="5" damping="2"/><geom size="0.1" pos="1 0 0"/></body>
            <body name="b" pos="3 0 0"><freejoint/><geom size="0.1"/></body></worldbody>
            <equality><connect body1="a" body2="b" anchor="1 0 0"/></equality></mujoco>"""
        model, _ = self.imported(self.written(text))
        self.assertEqual((len(model["constraints"]), model["forces"]), (1, []))
        model, _ = self.imported(self.written(text.replace("disable", "enable").replace('pos="3 0 0"', 'pos="1 0 0"')))
        self.assertEqual((len(model["constraints"]), len(model["forces"])), (2, 1))

    def test_urdf_refusals(self):
        link = f'<link name="a">{INERTIA}</link>'
        joint = '<joint name="j" type="continuous"><parent link="world"/><child link="a"/></joint>'
        self.refused("<robot name='r'><link name='world'/><link name='a'/>" + joint + "</robot>", "body 'a'.*joint 'j'.*no mass")
        self.refused("<robot name='r'><link name='world'/>" + link + joint + joint.replace('"j"', '"k"') + "</robot>", "link .a.: it is the child of two joints")
        self.refused("<robot name='r'>" + link + f"<link name='b'>{INERTIA}</link>" +
                     '<joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint>'
                     '<joint name="k" type="continuous"><parent link="b"/><child link="a"/></joint></robot>', "root|loop|tree")
        self.refused("<robot name='r'><link name='world'/>" + link + joint.replace("continuous", "spherical") + "</robot>", "type .*spherical|spherical")
        mimic = joint.replace("</joint>", '<mimic joint="j"/></joint>')
        self.refused("<robot name='r'><link name='world'/>" + link + mimic + "</robot>", "joint 'j': mimic is not supported")
        self.refused("<robot name='r'>" + link + "</robot>", "has no body that moves")
        self.refused("<robot name='r'><link", "model.xml")
        # The library leaves out an inertia that it cannot read. That of a welded link would be lost.
        weld = '<joint name="w" type="fixed"><parent link="a"/><child link="b"/></joint>'
        for right, wrong in (('mass value="1"', 'mass value="2 kg"'), ('mass value="1"', 'mass value="0,5"'), (' ixy="0"', ""),
                             ('<mass value="1"/>', ""), ('ixx="1"', 'ixx="one"')):
            self.refused("<robot name='r'><link name='world'/>" + link + joint + f"<link name='b'>{INERTIA.replace(right, wrong)}</link>" +
                         weld + "</robot>", r"[Ii]nertial.*Link \[b\]")

    def robot(self, count, more=""):
        """A chain of links with joints that have limits and friction"""
        parts = ['<robot name="arm"><link name="link_0"/>']
        for k in range(count):
            parts.append(f'<link name="link_{k + 1}">{INERTIA}{more}</link><joint name="left_middle_finger_joint_{k}" type="revolute">'
                         f'<parent link="link_{k}"/><child link="link_{k + 1}"/><axis xyz="0 1 0"/><origin xyz="0 0 0.1"/>'
                         '<limit lower="-1.5" upper="1.5" effort="40" velocity="3"/><dynamics friction="0.2"/></joint>')
        return "".join(parts) + "</robot>"

    def test_many_warnings(self):
        """The note of the model lists the warnings, or counts those of a kind if they are too long."""
        model, said = self.imported(self.written(self.robot(20), "arm.urdf"))
        self.assertIn("limits of joint 'left_middle_finger_joint_19'", model["note"])
        model, said = self.imported(self.written(self.robot(95), "arm.urdf"))
        self.assertIn("95 bodies with 95 degrees of freedom", said)
        self.assertIn("not imported: limits of joint 'left_middle_finger_joint_94'", said)
        self.assertEqual(model["note"], "Not imported: friction of joint (95); limits of joint (95).")

    def test_missing_meshes(self):
        visual = '<visual><geometry><mesh filename="meshes/arm.stl"/></geometry></visual>'
        model, said = self.imported(self.written(self.robot(1, visual), "arm.urdf"))
        self.assertIn("not imported: mesh meshes/arm.stl of link 'link_1', which does not exist", said)
        self.assertIn("mesh meshes/arm.stl of link 'link_1'", model["note"])

    def test_inertia_of_no_body(self):
        inertia = INERTIA.replace('ixx="1" iyy="1" izz="1"', 'ixx="1.486e-06" iyy="2e-07" izz="8.31e-07"')
        text = self.robot(1).replace(INERTIA, inertia)
        self.refused(text, r"model.xml: body 'link_1' \(inertia\): .*no principal moment of inertia may exceed the sum of the "
                     "other two.*; --balance-inertia replaces the moments by their mean")
        model, said = self.imported(self.written(text), "--balance-inertia")
        self.assertRegex(said, "not imported: inertia of body 'link_1', whose principal moments .* are replaced by their mean")
        np.testing.assert_allclose(model["bodies"][0]["inertia"], [8.39e-07] * 3, rtol=1e-9)

    def test_hostile_files(self):
        """Each of them is refused with one line at once."""
        begin = time.monotonic()
        self.refused(self.robot(20000), "behind a chain of [0-9]+ links, the limit is 1000")
        self.refused("<robot name='r'>" + "<a>" * 200000 + "</a>" * 200000 + "</robot>", 'model.xml:1: the element "a" is at level 201')
        self.refused("<mujoco><worldbody>" + '<body><joint/><geom size="1"/>' * 100000 + "</body>" * 100000 + "</worldbody></mujoco>",
                     "at level 201 of the nesting, the limit is 200")
        composite = '<composite type="grid" count="2000 2000 1" spacing="0.1"><geom size="0.01"/></composite>'
        self.refused(f'<mujoco><worldbody>\n<body name="a">{composite}</body></worldbody></mujoco>',
                     "model.xml:2: the composite has 4e[+]06 bodies, the limit is 10000")
        os.mkfifo(self.path("pipe.xml"))
        self.refused('<mujoco>\n\n<include file="pipe.xml"/></mujoco>', 'model.xml:3: "pipe.xml" is not a regular file')
        self.written('<mujoco><include file="pipe.xml"/></mujoco>', "other.xml")
        self.assertIn('other.xml:1: "pipe.xml" is not a regular file',
                      run(HILDA, "import", self.written('<mujoco><include file="other.xml"/></mujoco>'), expected=3))
        os.mkdir(self.path("meshes"))
        os.mkfifo(self.path("meshes/pipe.stl"))
        self.refused('<mujoco><compiler meshdir="meshes"/><asset><mesh name="m" file="pipe.stl"/></asset></mujoco>', "pipe.stl. is not a regular file")
        visual = '<visual><geometry><mesh filename="meshes/pipe.stl"/></geometry></visual>'
        self.refused(self.robot(1, visual), "meshes/pipe.stl. is not a regular file")
        self.assertLess(time.monotonic() - begin, 20)
        _, said = self.imported(self.written("<!-- <a><b> --><robot name='r'><![CDATA[<composite count='1e9'/>]]>" + self.robot(300)[18:]))
        self.assertIn("300 bodies", said)

    def test_mjcf_refusals(self):
        def body(inside):
            return f'<mujoco><worldbody><body name="a">{inside}<geom type="sphere" size="0.1"/></body></worldbody></mujoco>'
        self.refused(body('<joint name="j" armature="0.1"/>'), "joint 'j': armature is not supported")
        self.refused(body('<joint axis="1 0 0"/><joint axis="1 1 0"/>'), "body 'a': its joints .hinge hinge. have no counterpart")
        self.refused(body('<joint name="j" type="ball" damping="1"/>'), "joint 'j': stiffness and damping")
        self.refused(body("<joint").replace("</mujoco>", ""), "model.xml: MuJoCo [0-9.]+: ")
        self.refused(body("<joint/>").replace("<worldbody>", '<option density="1.2"/><worldbody>'), "medium")
        self.refused(body("<joint/>").replace('type="sphere" size="0.1"', 'type="mesh" mesh="m"')
                     .replace("<worldbody>", '<asset><mesh name="m" file="none.stl"/></asset><worldbody>'), "none.stl")

    def test_other_files(self):
        self.refused("<sdf/>", "root element 'sdf'; expected robot .URDF. or mujoco .MJCF.")
        self.refused("", "root element ''")
        self.assertIn("does not exist", run(HILDA, "import", self.path("none.urdf"), expected=5))
        kept = self.written("mine", "kept.json")
        self.assertIn("the file exists; --force", run(HILDA, "import", os.path.join(HERE, "arm.urdf"), "--output", kept, expected=3))
        with open(kept, encoding="utf-8") as file:
            self.assertEqual(file.read(), "mine")


if __name__ == "__main__":
    unittest.main()
