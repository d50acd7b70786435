#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A page that animates the result of a run: bodies, joints, contacts and forces, or particles and boundaries, with curves.

    view.py DIR OUTPUT [--geometry FILE] [--frames N] [--serve PORT] [--video SECONDS]

reads the tables and frames in DIR, and writes the file OUTPUT, which needs no other file. FILE has the meshes, joints and lines
of a model (Drawing::geometry); it is removed. The page uses three.js. With --serve the page is not written, but served on
127.0.0.1. With --video OUTPUT is a video of the page, of this duration; 0: that of the run if it is from 3 to 30 s, else 10 s.
Exit codes and messages are those of the program hilda.
"""
import argparse
import base64
import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile

try:
    import numpy as np
except ImportError:
    print("hilda: error: view: Python has no NumPy (Debian: apt-get install python3-numpy)", file=sys.stderr)
    sys.exit(7)

from result_files import Refused, folder_of_grains, frames_of, read_frame, read_json, read_table

HERE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "viewer")
LIBRARY = os.environ.get("HILDA_THREE", "/usr/share/javascript/three")
POSE_BYTES, COLUMN_BYTES, GRAIN_BYTES = 16e6, 8e6, 18e6  # at most, before base64
FLAT = 60    # a mesh with at most so many polygons has flat faces and edges
MOST_CONTACTS = 200
MOST_PAGE_BYTES = 256e6  # a larger page is not drawn by browsers
VIDEO_SIZE, VIDEO_RATE = (1280, 720), 25  # pixels, pictures per second
PARTICLES = (("Points", "Points"), ("PointData", "velocity"), ("PointData", "radius"), ("PointData", "id"))
UNITS = {"r": "m", "v": "m/s", "w": "rad/s", "a": "m/s²", "al": "rad/s²", "F": "N", "T": "N m"}


class Failed(Exception):
    """The page or video cannot be written or served."""


class NotInstalled(Exception):
    """A program or library is missing."""


def text64(values, kind):
    return base64.b64encode(np.ascontiguousarray(values, dtype=np.dtype(kind).newbyteorder("<")).tobytes()).decode()


def even(count, most):
    """The indices of at most `most` of `count` rows, the first and the last one included"""
    if count <= most:
        return np.arange(count)
    return np.unique(np.round(np.linspace(0, count - 1, max(int(most), 2))).astype(int))


def quaternions(A):
    """Unit quaternions (x, y, z, w) of rotation matrices, shape (..., 3, 3), with the largest component positive"""
    t = np.array([[1, -1, -1], [-1, 1, -1], [-1, -1, 1], [1, 1, 1]])
    diagonal = np.stack([A[..., k, k] for k in range(3)], axis=-1)
    squares = 1 + diagonal @ t.T  # 4 times the squares of the components
    largest = squares.argmax(axis=-1)
    x, y, z = (A[..., 2, 1] - A[..., 1, 2]), (A[..., 0, 2] - A[..., 2, 0]), (A[..., 1, 0] - A[..., 0, 1])
    xy, xz, yz = A[..., 0, 1] + A[..., 1, 0], A[..., 0, 2] + A[..., 2, 0], A[..., 1, 2] + A[..., 2, 1]
    candidates = [[squares[..., 0], xy, xz, x], [xy, squares[..., 1], yz, y], [xz, yz, squares[..., 2], z],
                  [x, y, z, squares[..., 3]]]
    candidates = np.stack([np.stack(row, axis=-1) for row in candidates], axis=-2)
    q = np.take_along_axis(candidates, largest[..., None, None], axis=-2)[..., 0, :]
    return q / np.linalg.norm(q, axis=-1, keepdims=True)


def unit_of(name):
    end = name.rsplit(".", 1)[-1]
    if name == "energy":
        return "J"
    for symbol in ("al", "r", "v", "w", "a", "F", "T"):
        if end in (symbol + "x", symbol + "y", symbol + "z"):
            return UNITS[symbol]
    if end.endswith("_energy"):
        return "J"
    return {"F_N": "N", "gap": "m", "slip": "m/s", "length": "m", "force": "N", "torque": "N m", "angle": "rad"}.get(end, "")


def columns_of(table, rows, most_bytes, left_out=()):
    """The columns of a table for curves, without the elements of rotation matrices"""
    names = [name for name in table.names if name != "t" and not re.search(r"\.A[1-3][1-3]$", name) and name not in left_out]
    first = [name for name in names if "." not in name]
    names = first + [name for name in names if "." in name]
    names = names[:max(len(first), int(most_bytes / (4 * len(rows))))]
    return {"times": text64(table["t"][rows], "f8"),
            "columns": [column_of(table, name, rows) for name in names]}


def column_of(table, name, rows):
    """The values of a column as an offset and 32-bit differences, which resolve small changes of large values"""
    values = table[name][rows]
    finite = values[np.isfinite(values)]
    offset = float(finite[0]) if len(finite) else 0.0
    return {"name": name, "unit": unit_of(name), "offset": offset, "values": text64(values - offset, "f4")}


def mesh_of(points, polygons, **more):
    """A mesh by triangles. The last ones, from `dark` on, are those in four of the eight octants about the centre of a round
    mesh: their darker tone shows its orientation."""
    points = np.asarray(points, dtype=float).reshape(-1, 3)
    triangles = np.array([[polygon[0], polygon[k], polygon[k + 1]] for polygon in polygons for k in range(1, len(polygon) - 1)],
                         dtype=int).reshape(-1, 3)
    is_flat = len(polygons) <= FLAT
    dark = np.zeros(len(triangles), bool)
    if not is_flat and len(points):
        centre = (points.min(axis=0) + points.max(axis=0)) / 2
        dark = np.prod(points[triangles].mean(axis=1) - centre, axis=1) > 0
    return {"points": text64(points, "f4"), "triangles": text64(np.concatenate([triangles[~dark], triangles[dark]]), "u4"),
            "dark": int(np.count_nonzero(~dark)), "flat": is_flat, **more}


class Box:
    def __init__(self):
        self.low, self.high = np.full(3, np.inf), np.full(3, -np.inf)

    def add(self, points):
        points = np.asarray(points, dtype=float).reshape(-1, 3)
        points = points[np.isfinite(points).all(axis=1)]
        if len(points):
            self.low, self.high = np.minimum(self.low, points.min(axis=0)), np.maximum(self.high, points.max(axis=0))


def contacts_of(table, trajectory, rows):
    """Contact points, normal and friction forces on the first body: of contacts.csv, or of the multipliers"""
    found, largest = [], 0.0
    for source in (table, trajectory):
        if source is None or found:
            continue
        for name in [n[:-4] for n in source.names if n.endswith(".F_N")][:MOST_CONTACTS]:
            part = lambda *ends: source.vectors(*[f"{name}.{end}" for end in ends])  # noqa: E731
            if f"{name}.nx" not in source.index:
                continue
            normal = part("nx", "ny", "nz") * source[f"{name}.F_N"][:, None]
            values = np.concatenate([part("Cx", "Cy", "Cz"), normal, part("Ff_x", "Ff_y", "Ff_z")], axis=1)
            if source is table and len(values) != len(trajectory.rows):
                continue
            values = np.nan_to_num(values[rows])
            size = max(np.linalg.norm(values[:, 3:6], axis=1).max(), np.linalg.norm(values[:, 6:], axis=1).max())
            if size > 0:
                found.append({"name": name, "values": text64(values, "f4")})
                largest = max(largest, float(size))
    return found, largest


def mechanism(folder, geometry, most, box, ground):
    """The poses, meshes, joints, lines and contacts of a run, and its tables. `ground`: box of the surfaces of the ground"""
    table = read_table(folder, "trajectory")
    if table is None:
        raise Refused(f"{folder}: run.h5 has no trajectory")
    bodies = [name[:-3] for name in table.names if name.endswith(".rx")]
    if bodies != geometry["bodies"]:
        raise Refused(f"{table.path}: has the bodies {', '.join(bodies)}; those of model.json are {', '.join(geometry['bodies'])}")
    rows = even(len(table.rows), min(most, POSE_BYTES / (28 * max(len(bodies), 1))))
    elements = [f"A{i}{j}" for i in "123" for j in "123"]
    r = np.stack([table.vectors(*(f"{b}.r{c}" for c in "xyz")) for b in bodies], axis=1)[rows]
    A = np.stack([table.vectors(*(f"{b}.{e}" for e in elements)) for b in bodies], axis=1)[rows]
    A = A.reshape(len(rows), len(bodies), 3, 3)
    if not (np.isfinite(r).all() and np.isfinite(A).all()):
        raise Refused(f"{table.path}: a pose is not finite")
    poses = np.concatenate([r, quaternions(A)], axis=2)
    flips = np.sign(np.sum(poses[1:, :, 3:] * poses[:-1, :, 3:], axis=2))
    poses[1:, :, 3:] *= np.cumprod(np.where(flips == 0, 1, flips), axis=0)[:, :, None]

    body, axis = np.unravel_index(np.ptp(r, axis=0).argmax(), r.shape[1:])
    at = even(len(rows), 60)

    def add(body, points):
        points = np.asarray(points, dtype=float).reshape(-1, 3)
        if body < 0:
            box.add(points)
        else:
            box.add(r[at, None, body] + np.einsum("tij,pj->tpi", A[at, body], points))
    meshes = []
    for mesh in geometry["meshes"]:
        meshes.append(mesh_of(mesh["points"], mesh["polygons"], body=mesh["body"], unbounded=mesh["unbounded"]))
        points = np.asarray(mesh["points"]).reshape(-1, 3)
        if mesh["body"] < 0:
            ground.add(points)
        if not mesh["unbounded"]:
            add(mesh["body"], points[even(len(points), 200)])
    for joint in geometry["joints"]:
        add(joint["body"], joint["point"])
    for line in geometry["lines"]:
        for end in "ij":
            add(line["body_" + end], line["point_" + end])
    contact_table = read_table(folder, "contacts")
    contacts, largest = contacts_of(contact_table, table, rows)
    tables = [columns_of(table, rows, COLUMN_BYTES)]
    for name in ("outputs", "forces"):
        more = read_table(folder, name)
        if more is not None:
            tables.append(columns_of(more, even(len(more.rows), most), COLUMN_BYTES / 4))
    if contact_table is not None:
        tables.append(columns_of(contact_table, even(len(contact_table.rows), most), COLUMN_BYTES / 4))
    return {"bodies": bodies, "times": text64(table["t"][rows], "f8"), "poses": text64(poses, "f4"), "meshes": meshes,
            "joints": geometry["joints"], "lines": geometry["lines"], "contacts": contacts, "largest_force": largest,
            "largest_motion": f"{bodies[body]}.r{'xyz'[axis]}"}, tables, table["t"]


def u16(values, largest):
    """The ratio to the largest value as a 16-bit number"""
    return np.round(np.clip(np.asarray(values, dtype=float) / np.where(largest == 0, 1, largest), 0, 1) * 65535).astype(np.uint16)


def grains(files, most, box):
    """The particles of the frames. Identifiers and radii that do not change are stored once."""
    count = max([len(read_frame(path, PARTICLES)["Points", "Points"]) for _, path in (files[0], files[-1])] + [1])
    files = [files[k] for k in even(len(files), min(most, max(2, GRAIN_BYTES / (8 * count))))]
    frames = []
    for _, path in files:
        frame = read_frame(path, PARTICLES)
        if len({len(frame[name]) for name in PARTICLES}) != 1 or not np.isfinite(frame["Points", "Points"]).all():
            raise Refused(f"{path}: has arrays of different lengths, or a position that is not finite")
        frames.append((frame["Points", "Points"], np.linalg.norm(frame["PointData", "velocity"], axis=1).astype(np.float32),
                       frame["PointData", "radius"], frame["PointData", "id"]))
        box.add(frames[-1][0])
    occupied = [frame for frame in frames if len(frame[0])]
    if not occupied:
        raise Refused(f"{files[0][1]}: no frame has particles")
    low = np.min([frame[0].min(axis=0) for frame in occupied], axis=0).astype(float)
    high = np.max([frame[0].max(axis=0) for frame in occupied], axis=0).astype(float)
    largest_radius, largest_speed = (float(max(frame[k].max() for frame in occupied)) for k in (2, 1))
    box.add(low - largest_radius), box.add(high + largest_radius)
    all_radius, all_id = frames[0][2], frames[0][3]
    written = []
    for points, speed, radius, number in frames:
        one = {"position": text64(u16(points - low, high - low), "u2"), "value": text64(u16(speed, largest_speed), "u2")}
        if not np.array_equal(radius, all_radius):
            one["radius"] = text64(u16(radius, largest_radius), "u2")
        if not np.array_equal(number, all_id):
            one["id"] = text64(number, "i4")
        written.append(one)
    return {"times": text64([t for t, _ in files], "f8"), "low": low.tolist(), "high": high.tolist(), "frames": written,
            "radius": text64(u16(all_radius, largest_radius), "u2"), "id": text64(all_id, "i4"),
            "largest_radius": largest_radius, "largest_value": largest_speed}, len(files), count


def boundaries(files, most, ground):
    files = [files[k] for k in even(len(files), most)]
    meshes, known, mesh_of_frame = [], {}, []
    for _, path in files:
        frame = read_frame(path, [("Points", "Points")])
        points = frame["Points", "Points"]
        connectivity, offsets = (frame.get(("Polys", name), np.zeros(0, int)) for name in ("connectivity", "offsets"))
        if len(connectivity) and not 0 <= connectivity.min() <= connectivity.max() < len(points):
            raise Refused(f"{path}: has a polygon with a point that does not exist")
        key = (points.tobytes(), connectivity.tobytes())
        if key not in known:
            known[key] = len(meshes)
            ground.add(points)
            polygons = np.split(connectivity, offsets[:-1]) if len(offsets) else []
            meshes.append(mesh_of(points, [polygon.tolist() for polygon in polygons]))
        mesh_of_frame.append(known[key])
    return {"times": text64([t for t, _ in files], "f8"), "mesh_of": mesh_of_frame, "meshes": meshes}


def up_of(folder):
    """The direction against gravity; z without gravity"""
    for name in ("model.json", "case.json"):
        path = os.path.join(folder, name)
        if not os.path.isfile(path):
            continue
        content = read_json(path)
        gravity = content.get("gravity") if isinstance(content, dict) else None
        if isinstance(gravity, list) and len(gravity) == 3 and all(isinstance(g, (int, float)) for g in gravity):
            size = math.sqrt(sum(g * g for g in gravity))
            if size > 0:
                axis = int(np.argmax(np.abs(gravity)))
                return [float(-np.sign(gravity[axis])) if k == axis else 0.0 for k in range(3)]
    return [0.0, 0.0, 1.0]


def floor_of(box, ground, up):
    """The height of the floor grid: below the motion. It is at the lowest surface of the ground, if there is one below the
    motion, and not so near that they are drawn at the same depth."""
    lowest = lambda of: float(min(np.dot(of.low, up), np.dot(of.high, up)))  # noqa: E731
    size = float(np.linalg.norm(box.high - box.low))
    at = lowest(box)
    if np.isfinite(ground.low).all() and at - size < lowest(ground) < at + 0.01 * size:
        return min(at, lowest(ground)) - 0.002 * size
    return at - 0.05 * size


def scene(folder, geometry, most):
    """The data of the page"""
    box, ground, tables, curves, parts, spans = Box(), Box(), [], [], {}, []
    text = ""
    if geometry is not None:
        parts["mechanism"], tables, t = mechanism(folder, geometry, most, box, ground)
        spans += [t[0], t[-1]]
        bodies = parts["mechanism"]["bodies"]
        curves = ["energy", parts["mechanism"].pop("largest_motion")]
        text = f"{len(bodies)} {'body' if len(bodies) == 1 else 'bodies'}, {len(t)} rows"
    grains_in = folder_of_grains(folder)
    frames = frames_of(grains_in)
    if "particles" in frames:
        parts["grains"], count, particles = grains(frames["particles"], most, box)
        spans += [frames["particles"][0][0], frames["particles"][-1][0]]
        text += (", " if text else "") + f"{particles} particles, {count} of {len(frames['particles'])} frames"
    if "boundaries" in frames:
        parts["boundaries"] = boundaries(frames["boundaries"], most, ground)
    run = read_table(grains_in, "run") if os.path.isfile(os.path.join(grains_in, "run.csv")) else None
    if run is not None:
        tables.append(columns_of(run, even(len(run.rows), most), COLUMN_BYTES / 2))
        curves += [column["name"] for column in tables[-1]["columns"][:2]] if not curves else []
        if not spans:
            spans = [run["t"][0], run["t"][-1]]
    if not parts:
        raise Refused(f"{folder}: has nothing to draw: no trajectory with a model, and no frames of particles (a case needs "
                      "\"frame_interval\")")
    if not np.isfinite(box.low).all():
        box.add([[-1, -1, -1], [1, 1, 1]])
    if np.linalg.norm(box.high - box.low) == 0:
        box.add(box.low - 0.5), box.add(box.high + 0.5)
    known = {column["name"] for table in tables for column in table["columns"]}
    up = up_of(folder)
    return {"title": os.path.basename(os.path.abspath(folder)), "text": text, "times": [float(min(spans)), float(max(spans))],
            "low": box.low.tolist(), "high": box.high.tolist(), "up": up, "floor": floor_of(box, ground, up),
            "tables": tables,
            "curves": [name for name in curves if name in known], **parts}


def read_text(*path):
    try:
        with open(os.path.join(*path), encoding="utf-8") as file:
            return file.read()
    except OSError as error:
        if path[0] == LIBRARY:
            raise NotInstalled(f"{error.filename}: three.js is missing (Debian: apt-get install libjs-three)") from None
        raise


def page(data):
    """The file of the page"""
    import html
    values = {"TITLE": html.escape(data["title"]), "THREE": read_text(LIBRARY, "three.min.js"),
              "CONTROLS": read_text(LIBRARY, "examples", "js", "controls", "OrbitControls.js"),
              "SCENE": read_text(HERE, "scene.js"), "REFERENCES": read_text(HERE, "references.js"),
              "PLOTS": read_text(HERE, "plots.js"), "MAIN": read_text(HERE, "main.js"),
              # "<" could end the element of the page, or begin another one
              "DATA": json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")}
    return re.sub("@([A-Z]+)@", lambda match: values[match.group(1)], read_text(HERE, "page.html"))


def stamp(folder):
    """A text that changes when the tables or frames in the folder do"""
    files = [os.path.join(folder, name) for name in ("trajectory.csv", "run.h5")]
    files += [os.path.join(folder_of_grains(folder), name) for name in ("run.csv", "run.pvd")]
    return ",".join(f"{os.stat(file).st_mtime_ns}-{os.stat(file).st_size}" for file in files if os.path.isfile(file))


def serve(folder, geometry, most, port):
    """Serves the page until Ctrl-C. It is made again for each request."""
    from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self):
            if self.headers.get("Host", "").rsplit(":", 1)[0] not in ("127.0.0.1", "localhost"):
                return self.send(403, "text/plain", "only for this machine")
            if self.path == "/stamp":
                return self.send(200, "text/plain", stamp(folder))
            if self.path != "/":
                return self.send(404, "text/plain", "no such page")
            try:
                at = stamp(folder)
                self.send(200, "text/html", page({**scene(folder, geometry, most), "live": at}))
            except (Refused, NotInstalled, OSError) as error:
                self.send(503, "text/plain", str(error))

        def send(self, code, kind, text):
            body = text.encode()
            self.send_response(code)
            self.send_header("Content-Type", kind + "; charset=utf-8")
            self.send_header("Content-Length", str(len(body)))
            self.send_header("Cache-Control", "no-store")
            self.end_headers()
            self.wfile.write(body)

        def log_message(self, *_):
            pass

    try:
        server = ThreadingHTTPServer(("127.0.0.1", port), Handler)
    except OSError as error:
        raise Failed(f"view: port {port} of 127.0.0.1: {error.strerror}; another one is chosen by --port") from None
    print(f"serving       http://127.0.0.1:{server.server_port}/ (Ctrl-C ends it)", flush=True)
    try:
        server.serve_forever()
    except KeyboardInterrupt:
        pass


def remove(path):
    try:
        os.remove(path)
    except FileNotFoundError:
        pass


def write_whole(path, text):
    """Writes a file that is complete or absent; a link in its place is replaced, not followed"""
    new = path + ".new"
    try:
        remove(new)  # of a program that was killed
        with open(new, "x", encoding="utf-8") as file:
            file.write(text)
        os.replace(new, path)
    except OSError as error:
        remove(new)
        raise OSError(error.errno, error.strerror, path) from None  # that of a full disk names no file


def write_video(path, data, seconds):
    """A video of the page, from its first to its last time"""
    import browser
    if not browser.is_installed():
        raise NotInstalled("view: a video needs chromedriver (Debian: apt-get install chromium-driver)")
    if shutil.which("ffmpeg") is None:
        raise NotInstalled("view: a video needs ffmpeg (Debian: apt-get install ffmpeg)")
    first, last = data["times"]
    if seconds == 0:
        seconds = last - first if 3 <= last - first <= 30 else 10.0
    times = np.linspace(first, last, max(2, round(VIDEO_RATE * seconds)))
    with tempfile.TemporaryDirectory() as folder, browser.Browser(*VIDEO_SIZE) as window:
        write_whole(os.path.join(folder, "view.html"), page(data))
        window.open("file://" + os.path.join(folder, "view.html"))
        window.wait("viewer.ready || viewer.errors.length", seconds=math.inf)
        window.run("viewer.picture_only()")
        remove(path + ".new")
        open(path + ".new", "xb").close()
        words = ["ffmpeg", "-y", "-loglevel", "error", "-f", "image2pipe", "-framerate", str(VIDEO_RATE), "-c:v", "png", "-i", "-",
                 "-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "20", "-f", "mp4", path + ".new"]
        with subprocess.Popen(words, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as encoder:
            try:
                for n, t in enumerate(times):
                    window.show_time(float(t))
                    encoder.stdin.write(window.screenshot())
                    if sys.stderr.isatty():
                        print(f"\r{n + 1} of {len(times)} pictures", end="", file=sys.stderr, flush=True)
            except BrokenPipeError:
                pass  # ffmpeg has ended, with a message
            finally:
                _, message = encoder.communicate()
                if sys.stderr.isatty():
                    print("\r" + 40 * " ", end="\r", file=sys.stderr, flush=True)
        errors = window.run("return viewer.errors")
    if encoder.returncode != 0 or errors:
        reason = "; ".join(errors) or message.decode(errors="replace").strip().replace("\n", "; ")
        raise Failed(f"view: {path}: the video was not written: {reason}")
    os.replace(path + ".new", path)
    return f"{len(times)} pictures, {len(times) / VIDEO_RATE:g} s"


def write(arguments):
    geometry = None
    if arguments.geometry:
        geometry = read_json(arguments.geometry)
        os.remove(arguments.geometry)
    if arguments.serve is not None:
        return serve(arguments.folder, geometry, arguments.frames, arguments.serve)
    data = scene(arguments.folder, geometry, arguments.frames)
    text = data["text"]
    if arguments.video is not None:
        try:
            text += ", " + write_video(arguments.output, data, arguments.video)
        finally:  # also after an interruption
            remove(arguments.output + ".new")
    else:
        text_of_page = page(data)
        if len(text_of_page) > MOST_PAGE_BYTES:
            raise Refused(f"{arguments.folder}: the page would have {len(text_of_page) / 1e6:.0f} MB, at most "
                          f"{MOST_PAGE_BYTES / 1e6:.0f} MB are written; a smaller --frames, or fewer particles or vertices")
        write_whole(arguments.output, text_of_page)
    print(f"written       {arguments.output}: {text}, {os.path.getsize(arguments.output) / 1e6:.1f} MB", flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder")
    parser.add_argument("output")
    parser.add_argument("--geometry")
    parser.add_argument("--frames", type=int, default=1000)
    parser.add_argument("--serve", type=int)
    parser.add_argument("--video", type=float)
    try:
        write(parser.parse_args())
        return
    except Refused as refused:
        code, text = 3, str(refused)
    except NotInstalled as missing:
        code, text = 7, str(missing)
    except (Failed, RuntimeError, TimeoutError) as failed:
        code, text = 5, str(failed).splitlines()[0]
    except OSError as error:
        code, text = 5, f"{error.filename or 'standard output'}: {error.strerror}"
    except KeyboardInterrupt:
        code, text = 130, "view: interrupted; nothing was written"
    try:
        print(f"hilda: error: {text}", file=sys.stderr, flush=True)
    except OSError:  # stderr is closed: the exit code is all that is left
        os._exit(code)
    sys.exit(code)


if __name__ == "__main__":
    main()
