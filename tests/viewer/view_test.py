# SPDX-License-Identifier: GPL-3.0-or-later
"""Pages of hilda view: their data against the tables, and their behaviour in a browser (headless Chromium).

    HILDA_PROGRAM=build/release/hilda python3 tests/viewer/view_test.py

The tests in a browser are skipped without chromedriver (Debian: chromium-driver).
"""
import base64
import csv
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest
import zlib

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "studies", "plots"))
import browser as chromium  # noqa: E402
from browser import Browser  # noqa: E402

HILDA = os.path.abspath(os.environ["HILDA_PROGRAM"])
GRANULAR = os.path.join(os.path.dirname(HILDA), "hilda-granular")
EXAMPLES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "examples")
HAS_BROWSER = chromium.is_installed()


def hilda(*words, program=HILDA, expected=0):
    """Runs the program. Returns what it has written."""
    done = subprocess.run([program, *words], capture_output=True, text=True)
    assert done.returncode == expected, (words, done.returncode, done.stdout, done.stderr)
    return done.stdout + done.stderr


def data_of(page):
    with open(page, encoding="utf-8") as file:
        text = file.read()
    return json.loads(re.search(r'id="data">(.*?)</script>', text, re.DOTALL).group(1)), text


def numbers(text, kind):
    return np.frombuffer(base64.b64decode(text), kind)


def table(path):
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


def rotation(q):
    """Rotation matrix of a unit quaternion (x, y, z, w)"""
    x, y, z, w = q
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def pixels(png):
    """The image as an array, height × width × channels. Only the filters and types that browsers write"""
    at, chunks, shape = 8, [], None
    while at < len(png):
        size, kind = int.from_bytes(png[at:at + 4], "big"), png[at + 4:at + 8]
        body = png[at + 8:at + 8 + size]
        if kind == b"IHDR":
            shape = int.from_bytes(body[4:8], "big"), int.from_bytes(body[:4], "big"), {2: 3, 6: 4}[body[9]]
        elif kind == b"IDAT":
            chunks.append(body)
        at += 12 + size
    height, width, channels = shape
    raw = np.frombuffer(zlib.decompress(b"".join(chunks)), np.uint8).reshape(height, 1 + width * channels)
    image = np.zeros((height + 1, width + 1, channels), np.int64)  # with a border of zeros
    for n, (kind, line) in enumerate(zip(raw[:, 0], raw[:, 1:].reshape(height, width, channels).astype(np.int64)), 1):
        above = image[n - 1]
        if kind in (0, 2):
            image[n, 1:] = line + (above[1:] if kind == 2 else 0)
        elif kind == 1:
            image[n, 1:] = np.cumsum(line, axis=0)
        else:
            for k in range(1, width + 1):
                a, b, c = image[n, k - 1], above[k], above[k - 1]
                if kind == 3:
                    guess = (a + b) // 2
                else:
                    p = a + b - c
                    pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
                    guess = np.where((pa <= pb) & (pa <= pc), a, np.where(pb <= pc, b, c))
                image[n, k] = (line[k - 1] + guess) % 256
        image[n] %= 256
    return image[1:, 1:]


class Pages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.root = cls.temporary.name
        cls.pendulum = cls.folder("pendulum")
        hilda("run", "double_pendulum_moving", "--integrator", "rA-half-1", "--step", "1e-3", "--end", "0.5", "--output", cls.pendulum)
        cls.bowl = cls.folder("bowl")
        hilda("run", "braked_ball_in_bowl", "--end", "0.5", "--contacts", "--output", cls.bowl)
        cls.grains = cls.folder("grains")
        hilda(os.path.join(EXAMPLES, "cases", "box_fill.json"), "--output", cls.grains, "--quiet", program=GRANULAR)
        for folder in (cls.pendulum, cls.bowl, cls.grains):
            hilda("view", folder)

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    @classmethod
    def folder(cls, name):
        return os.path.join(cls.root, name)

    def test_page_needs_no_other_file(self):
        for folder in (self.pendulum, self.grains):
            _, text = data_of(os.path.join(folder, "view.html"))
            self.assertIn("MIT licence", text)
            elements = re.sub(r"<script[^>]*>.*?</script>", "", text, flags=re.DOTALL)
            self.assertNotRegex(elements, r"(src|href)=\"(?!data:,)")
            self.assertNotRegex(elements, r"url\(")

    def test_poses_and_columns_are_those_of_the_table(self):
        data, _ = data_of(os.path.join(self.pendulum, "view.html"))
        rows = table(os.path.join(self.pendulum, "trajectory.csv"))
        mechanism = data["mechanism"]
        np.testing.assert_array_equal(numbers(mechanism["times"], "<f8"), rows["t"])
        poses = numbers(mechanism["poses"], "<f4").reshape(len(rows["t"]), len(mechanism["bodies"]), 7)
        for b, body in enumerate(mechanism["bodies"]):
            for c, axis in enumerate("xyz"):
                np.testing.assert_allclose(poses[:, b, c], rows[f"{body}.r{axis}"], atol=1e-6)
            for k in range(0, len(rows["t"]), 50):
                A = [[rows[f"{body}.A{i}{j}"][k] for j in "123"] for i in "123"]
                np.testing.assert_allclose(rotation(poses[k, b, 3:]), A, atol=1e-6)
        # The interpolation between two rows takes the shorter way.
        self.assertTrue((np.sum(poses[1:, :, 3:] * poses[:-1, :, 3:], axis=2) > 0.99).all())
        columns = {column["name"]: column for column in data["tables"][0]["columns"]}
        self.assertEqual(columns["energy"]["unit"], "J")
        energy = columns["energy"]["offset"] + numbers(columns["energy"]["values"], "<f4").astype(float)
        change = rows["energy"] - rows["energy"][0]
        np.testing.assert_allclose(energy - energy[0], change, atol=1e-6 * abs(change).max())

    def test_contacts_have_the_forces_of_the_table(self):
        data, _ = data_of(os.path.join(self.bowl, "view.html"))
        rows = table(os.path.join(self.bowl, "contacts.csv"))
        (contact,) = data["mechanism"]["contacts"]
        values = numbers(contact["values"], "<f4").reshape(-1, 9)
        name = contact["name"]
        np.testing.assert_allclose(values[:, 0], rows[f"{name}.Cx"], atol=1e-6)
        np.testing.assert_allclose(np.linalg.norm(values[:, 3:6], axis=1), rows[f"{name}.F_N"], rtol=1e-5)
        np.testing.assert_allclose(values[:, 7], rows[f"{name}.Ff_y"], rtol=1e-5, atol=1e-6)

    def test_particles_are_those_of_the_last_frame(self):
        data, _ = data_of(os.path.join(self.grains, "view.html"))
        grains = data["grains"]
        rows = table(os.path.join(self.grains, "particles.csv"))
        last = grains["frames"][-1]
        low, high = np.array(grains["low"]), np.array(grains["high"])
        points = low + (high - low) * numbers(last["position"], "<u2").reshape(-1, 3) / 65535
        order = np.argsort(numbers(last.get("id", grains["id"]), "<i4"))
        expected = np.stack([rows[c] for c in ("x", "y", "z")], axis=1)[np.argsort(rows["id"])]
        np.testing.assert_allclose(points[order], expected, atol=(high - low).max() / 65535)
        radius = grains["largest_radius"] * numbers(last.get("radius", grains["radius"]), "<u2") / 65535
        np.testing.assert_allclose(radius[order], rows["radius"][np.argsort(rows["id"])], rtol=1e-4)

    def test_rows_and_frames_are_limited(self):
        page = self.folder("few.html")
        hilda("view", self.pendulum, "--frames", "11", "--output", page)
        data, _ = data_of(page)
        times = numbers(data["mechanism"]["times"], "<f8")
        self.assertEqual(len(times), 11)
        self.assertEqual((times[0], times[-1]), (0.0, 0.5))

    def test_hdf5_and_unbounded_surfaces(self):
        folder = self.folder("hdf5")
        hilda("run", "rolling_ball", "--end", "0.2", "--format", "hdf5", "--output", folder)
        hilda("view", folder)
        data, _ = data_of(os.path.join(folder, "view.html"))
        self.assertTrue(any(mesh["unbounded"] for mesh in data["mechanism"]["meshes"]))

    def test_co_simulation(self):
        folder = self.folder("strike")
        hilda("cosim", os.path.join(EXAMPLES, "cosim", "strike", "strike.json"), "--end", "0.02", "--output", folder)
        hilda("view", folder)
        data, _ = data_of(os.path.join(folder, "view.html"))
        self.assertEqual(data["mechanism"]["bodies"], ["ball"])
        self.assertIn("grains", data)

    def test_floor_is_below_the_motion(self):
        for folder in (self.pendulum, self.bowl, self.grains):
            data, _ = data_of(os.path.join(folder, "view.html"))
            low, high, up = (np.array(data[name]) for name in ("low", "high", "up"))
            size = np.linalg.norm(high - low)
            below = min(low @ up, high @ up) - data["floor"]
            self.assertGreater(below, 0.001 * size)  # another depth than that of a surface at the lowest point
            if folder == self.pendulum:
                self.assertLess(below, 0.1 * size)

    def test_refusals(self):
        def refused(expected, *words, code=3):
            text = hilda("view", *words, expected=code)
            self.assertRegex(text, expected)
            self.assertEqual(text.count("\n"), 1, text)
        refused("does not exist|not a directory", self.folder("none"))
        empty = self.folder("empty")
        os.mkdir(empty)
        refused("contains no trajectory.csv, run.h5, run.pvd or run.csv", empty)
        without_model = self.folder("without_model")
        shutil.copytree(self.pendulum, without_model)
        os.remove(os.path.join(without_model, "model.json"))
        refused("contains no model.json", without_model)
        without_frames = self.folder("without_frames")
        shutil.copytree(self.grains, without_frames)
        os.remove(os.path.join(without_frames, "run.pvd"))
        refused("has nothing to draw.*frame_interval", without_frames)
        damaged = self.folder("damaged")
        shutil.copytree(self.pendulum, damaged)
        with open(os.path.join(damaged, "trajectory.csv"), "a", encoding="utf-8") as file:
            file.write("1,what\n1,what\n")
        refused("trajectory.csv.*rows that are not numbers", damaged)
        self.refuse_changed_tables(refused)
        self.refuse_changed_frames(refused)
        refused("either --mp4 or --serve", self.pendulum, "--mp4", "--serve", code=2)
        refused("--seconds needs --mp4", self.pendulum, "--seconds", "3", code=2)
        note = self.folder("note.txt")
        with open(note, "w", encoding="utf-8") as file:
            file.write("mine")
        refused("is no page of hilda view; it is not replaced", self.pendulum, "--output", note)
        refused("is no MP4 video; it is not replaced", self.pendulum, "--output", note, "--mp4")
        refused("--frames", self.pendulum, "--frames", "0", code=2)
        # without three.js
        environment = {**os.environ, "HILDA_THREE": self.folder("empty")}
        done = subprocess.run([HILDA, "view", self.pendulum], capture_output=True, text=True, env=environment)
        self.assertEqual(done.returncode, 7)
        self.assertIn("three.js is missing (Debian: apt-get install libjs-three)", done.stderr)

    def test_full_disk_and_large_page(self):
        """A page that cannot be written, or is too large for a browser, leaves no file."""
        folder = self.folder("full")
        shutil.copytree(self.pendulum, folder)
        for name in ("view.html", "view.html.new"):
            if os.path.exists(os.path.join(folder, name)):
                os.remove(os.path.join(folder, name))
        before = sorted(os.listdir(folder))
        done = subprocess.run([HILDA, "view", folder], capture_output=True, text=True,
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (100000, 100000)))
        self.assertEqual((done.returncode, done.stderr), (5, f"hilda: error: {folder}/view.html: File too large\n"))
        self.assertEqual(sorted(os.listdir(folder)), before)
        with open(os.path.join(folder, "model.json"), encoding="utf-8") as file:
            model = json.load(file)
        code = ("import runpy, sys; sys.path.insert(0, sys.argv[1]); import view; view.MOST_PAGE_BYTES = 1000; "
                "sys.argv = ['view.py', *sys.argv[2:]]; view.main()")
        plots = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "studies", "plots")
        with open(self.folder("geometry.json"), "w", encoding="utf-8") as file:
            json.dump({"bodies": [body["name"] for body in model["bodies"]], "meshes": [], "joints": [], "lines": []}, file)
        done = subprocess.run([sys.executable, "-B", "-c", code, plots, folder, os.path.join(folder, "view.html"), "--geometry",
                               self.folder("geometry.json")], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertRegex(done.stderr, "the page would have [0-9]+ MB, at most 0 MB are written; a smaller --frames")
        self.assertEqual(sorted(os.listdir(folder)), before)

    def changed(self, folder, name, change):
        """A copy of the folder in which a file has other bytes"""
        copy = tempfile.mkdtemp(dir=self.root)
        shutil.copytree(folder, copy, dirs_exist_ok=True)
        path = os.path.join(copy, name)
        with open(path, "rb") as file:
            content = file.read()
        with open(path, "wb") as file:
            file.write(change(content))
        return copy

    def refuse_changed_tables(self, refused):
        def table(change):
            return self.changed(self.pendulum, "trajectory.csv", change)
        refused("trajectory.csv.*there is no column t", table(lambda text: text.replace(b"t,", b"x,", 1)))
        refused("trajectory.csv.*there is no column bar_1.A23", table(lambda text: text.replace(b"bar_1.A23", b"x", 1)))
        refused("trajectory.csv.*t is not a finite number in row 1", table(lambda text: text.replace(b"\n0,", b"\nnan,", 1)))
        refused("trajectory.csv.*UTF-8", table(lambda text: text + b"\xff\n"))
        refused("has the bodies .*arm.*; those of model.json are bar_1", table(lambda text: text.replace(b"bar_1.", b"arm.")))
        refused("model.json", self.changed(self.pendulum, "model.json", lambda text: text[:100]))
        copy = self.changed(self.pendulum, "trajectory.csv", lambda text: text)
        os.rename(os.path.join(copy, "trajectory.csv"), os.path.join(copy, "run.h5"))
        refused("run.h5: cannot be read", copy)

    def refuse_changed_frames(self, refused):
        def frames(change):
            return self.changed(self.grains, "run.pvd", change)
        refused("run.pvd: is not a list of frames", frames(lambda text: text[:-30]))
        refused("run.pvd: is not a list of frames", frames(lambda text: text.replace(b"file=", b"of=")))
        name = next(name for name in sorted(os.listdir(os.path.join(self.grains, "vtk"))) if name.startswith("particles"))

        def frame(change):
            return self.changed(self.grains, os.path.join("vtk", name), change)
        refused(name + ": is not a frame of HILDA: Points has no array Points", frame(lambda _: b""))
        refused(name + ": is incomplete, or not a frame", frame(lambda text: text[:len(text) // 2]))
        refused(name + ": is not a frame of HILDA: PointData has no array radius",
                frame(lambda text: text.replace(b'"radius"', b'"other"')))
        self.assertEqual([name for name in os.listdir(self.grains) if ".geometry-" in name], [])

    @unittest.skipUnless(HAS_BROWSER and shutil.which("ffmpeg"), "chromedriver or ffmpeg is not installed")
    def test_video(self):
        said = hilda("view", self.pendulum, "--mp4", "--seconds", "1")
        self.assertIn("25 pictures, 1 s", said)
        video = os.path.join(self.pendulum, "view.mp4")
        decoded = subprocess.run(["ffmpeg", "-loglevel", "error", "-i", video, "-f", "rawvideo", "-pix_fmt", "rgb24", "-"],
                                 capture_output=True, check=True).stdout
        images = np.frombuffer(decoded, np.uint8).reshape(-1, 720, 1280, 3)
        self.assertEqual(len(images), 25)
        self.assertGreater(np.count_nonzero(abs(images[0].astype(int) - images[-1]) > 60), 3000)  # the pendulum has moved
        hilda("view", self.pendulum, "--mp4", "--seconds", "0.2")  # replaces a video
        with open(video, "rb") as file:
            before = file.read()
        long = subprocess.Popen([HILDA, "view", self.pendulum, "--mp4", "--seconds", "60"], stderr=subprocess.PIPE, text=True)
        while not os.path.exists(video + ".new"):
            self.assertIsNone(long.poll())
        long.send_signal(signal.SIGINT)
        self.assertIn("interrupted", long.communicate(timeout=30)[1])
        self.assertEqual(long.returncode, 130)
        self.assertFalse(os.path.exists(video + ".new"))
        with open(video, "rb") as file:
            self.assertEqual(file.read(), before)

    def test_server(self):
        import urllib.error
        import urllib.request
        server = subprocess.Popen([HILDA, "view", self.pendulum, "--serve", "--port", "0"], stdout=subprocess.PIPE, text=True)
        try:
            url = server.stdout.readline().split()[1]
            self.assertTrue(url.startswith("http://127.0.0.1:"))
            with urllib.request.urlopen(url, timeout=30) as answer:
                self.assertIn('"live":', answer.read().decode())
            for path, host, code in (("x", None, 404), ("", "example.org", 403)):
                request = urllib.request.Request(url + path, headers={"Host": host} if host else {})
                with self.assertRaises(urllib.error.HTTPError) as refused:
                    urllib.request.urlopen(request, timeout=30)
                self.assertEqual(refused.exception.code, code)
                refused.exception.close()
        finally:
            server.send_signal(signal.SIGINT)
            self.assertEqual(server.wait(30), 0)
            server.stdout.close()

    @unittest.skipUnless(HAS_BROWSER, "chromedriver is not installed")
    def test_browser(self):
        with Browser() as browser:
            def opened(folder):
                browser.open("file://" + os.path.join(folder, "view.html"))
                seconds = browser.wait("viewer.ready || viewer.errors.length")
                self.assertEqual(browser.run("return viewer.errors"), [])
                self.assertLess(seconds, 5)
                image = pixels(browser.screenshot())[:500, :900, :3]
                self.assertGreater(len(np.unique(image.reshape(-1, 3), axis=0)), 50)  # a shaded picture
                return image

            first = opened(self.pendulum)
            rows = table(os.path.join(self.pendulum, "trajectory.csv"))
            browser.run("viewer.set_time(0.25)")
            browser.wait("viewer.t === 0.25")
            k = int(np.argmin(abs(rows["t"] - 0.25)))
            for body in ("bar_1", "bar_2"):
                r = [rows[f"{body}.r{c}"][k] for c in "xyz"]
                browser.wait(f"Math.abs(viewer.position('{body}')[2] - {r[2]}) < 1e-5")
                np.testing.assert_allclose(browser.run("return viewer.position(arguments[0])", body), r, atol=1e-5)
                at = browser.run("return viewer.project(...arguments)", *r)
                self.assertEqual(browser.run("return viewer.pick(...arguments)", *at), body)
                self.assertIn(body, browser.run("return document.getElementById('picked').textContent"))
            self.assertEqual(browser.run("return viewer.pick(5, 5)"), "")
            self.assertGreater(np.count_nonzero(first != pixels(browser.screenshot())[:500, :900, :3]), 1000)
            browser.run("viewer.set_time(0); viewer.play(true)")
            browser.wait("viewer.t > 0.001 && viewer.frames > 3")

            self.check_references(browser)
            opened(self.bowl)
            self.assertFalse(browser.run("return document.getElementById('forces').hidden"))

            opened(self.grains)
            rows = table(os.path.join(self.grains, "particles.csv"))
            browser.run("viewer.set_time(1e9)")
            browser.wait("viewer.t > 0.29")
            top = int(np.argmax(rows["z"]))
            browser.wait("viewer.frames > 1")
            at = browser.run("return viewer.project(...arguments)", *(rows[c][top] for c in ("x", "y", "z")))
            self.assertEqual(browser.run("return viewer.pick(...arguments)", *at), f"particle {int(rows['id'][top])}")
            self.assertEqual([m for m in browser.messages() if "SEVERE" in m or "Uncaught" in m], [])

    def check_references(self, browser):
        """Grid, triad and scale bar of the page that is open: their lengths, and that they follow the camera and the check box"""
        def text(name):
            return browser.run("return document.getElementById(arguments[0]).textContent", name)

        def redrawn(script):
            # Frame count and change in one script: no frame of a page that plays lies between them.
            frames = browser.run(f"const frames = viewer.frames; {script}; return frames")
            browser.wait(f"viewer.frames > {frames}")
        spacing = browser.run("return viewer.grid.spacing")
        self.assertIn(round(spacing / 10 ** np.floor(np.log10(spacing) + 1e-9), 9), (1, 2, 5))
        self.assertEqual(text("grid"), f"grid {spacing:g} m")
        x, y, z = np.array(browser.run("return Array.from(viewer.grid.object.geometry.attributes.position.array)")).reshape(-1, 3).T
        floor = browser.run("return JSON.parse(document.getElementById('data').textContent).floor")
        np.testing.assert_allclose(z, floor, rtol=1e-6)
        np.testing.assert_allclose(np.concatenate([x, y]) / spacing, np.round(np.concatenate([x, y]) / spacing), atol=1e-4)

        for side, towards in (("+x", "x"), ("-y", "y"), ("top", "z")):
            redrawn(f"const side = document.getElementById('side_of'); side.value = '{side}'; side.onchange({{target: side}})")
            # The length of the bar is that of a length across the view at its centre.
            metres, pixels, c, r = browser.run(
                "const { camera, controls } = viewer, m = viewer.scale_bar.metres;"
                "return [m, document.querySelector('#scale i').getBoundingClientRect().width, controls.target.toArray(),"
                "        camera.matrixWorld.elements.slice(0, 3)]")
            ends = [browser.run("return viewer.project(...arguments)", *(np.array(c) + s * metres * np.array(r))) for s in (0, 1)]
            self.assertAlmostEqual(np.hypot(*np.subtract(*ends)), pixels, delta=0.5)
            self.assertTrue(60 < pixels < 140, pixels)
            shown = text("scale").removesuffix(text("grid")).split()
            self.assertAlmostEqual(float(shown[0]) * {"m": 1, "mm": 1e-3, "km": 1e3}[shown[1]], metres, delta=1e-9 * metres)
            # The axis towards the viewer has the shortest line, and its group is the last one.
            axes = browser.run("return Array.from(document.querySelectorAll('#triad g'), g => [g.textContent,"
                               "  Math.hypot(g.firstChild.x2.baseVal.value, g.firstChild.y2.baseVal.value)])")
            self.assertEqual(min(axes, key=lambda axis: axis[1])[0], towards)
            self.assertEqual(sorted(name for name, _ in axes), ["x", "y", "z"])

        for shown in (False, True):
            redrawn("document.dispatchEvent(new KeyboardEvent('keydown', { key: 'g' }))")
            self.assertEqual(browser.run("return document.getElementById('references').checked"), shown)
            self.assertEqual(browser.run("return viewer.grid.object.visible"), shown)
            for name in ("triad", "scale"):
                visible = browser.run("return document.getElementById(arguments[0]).getBoundingClientRect().width > 0", name)
                self.assertEqual(visible, shown)


if __name__ == "__main__":
    unittest.main()
