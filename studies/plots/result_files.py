# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of the tables and frames of a result. What cannot be read is Refused with its place."""
import csv
import json
import os
import re
import xml.etree.ElementTree

import numpy as np


class Refused(Exception):
    """The results cannot be shown."""


def open_text(path):
    return open(path, encoding="utf-8", newline="")


def read_json(path):
    """The content of a JSON file"""
    try:
        with open_text(path) as file:
            return json.load(file)
    except ValueError as error:  # also text that is not UTF-8
        raise Refused(f"{path}: is not a JSON file: {error}") from None


class Table:
    """Columns of numbers by name"""

    def __init__(self, path, names, rows):
        self.path = path
        self.names = names
        self.rows = rows
        self.index = {name: k for k, name in enumerate(names)}
        not_numbers = np.flatnonzero(~np.isfinite(self["t"]))
        if len(not_numbers):
            raise Refused(f"{path}: t is not a finite number in row {not_numbers[0] + 1}")

    def __getitem__(self, name):
        if name not in self.index:
            raise Refused(f"{self.path}: there is no column {name}")
        return self.rows[:, self.index[name]]

    def vectors(self, *names):
        return np.stack([self[name] for name in names], axis=-1)


def read_table(folder, name):
    """The table NAME.csv, or of run.h5; None if there is none"""
    path = os.path.join(folder, name + ".csv")
    if os.path.isfile(path):
        return read_csv(path)
    path = os.path.join(folder, "run.h5")
    return read_hdf5(path, name) if os.path.isfile(path) else None


MOST_BYTES = 2 << 30  # of a table that is read


def read_csv(path):
    if os.path.getsize(path) > MOST_BYTES:
        raise Refused(f"{path}: has {os.path.getsize(path) / 1e6:.0f} MB, at most {MOST_BYTES / 1e6:.0f} MB are read; a run "
                      "with a longer --interval writes fewer rows")
    try:
        with open_text(path) as file:
            names = next(csv.reader([file.readline()]), [])
            lines = [line for line in file if line.strip() and not line.startswith("#")]
        if lines and lines[-1].count(",") != lines[0].count(","):
            lines.pop()  # a run that goes on has written a part of its last row
        rows = np.array([[float(cell or "nan") for cell in cells] for cells in csv.reader(lines)], dtype=float)
        if rows.size == 0 or rows.shape[1] != len(names):
            raise ValueError
    except UnicodeDecodeError:
        raise Refused(f"{path}: is not a text in UTF-8") from None
    except (ValueError, csv.Error):
        raise Refused(f"{path}: has no rows, or rows that are not numbers") from None
    return Table(path, names, rows)


def read_hdf5(path, name):
    try:
        import h5py
    except ImportError:
        raise Refused(f"{path}: Python has no h5py (Debian: apt-get install python3-h5py)") from None
    try:
        with h5py.File(path) as file:
            if name not in file:
                return None
            columns = {key: np.asarray(values, dtype=float) for key, values in file[name].items()}
    except (OSError, ValueError, AttributeError) as error:
        raise Refused(f"{path}: cannot be read: {error}".splitlines()[0]) from None
    rows = min((len(values) for values in columns.values()), default=0)
    if rows == 0:
        raise Refused(f"{path}: the table {name} has no rows")
    return Table(path, list(columns), np.stack([values[:rows] for values in columns.values()], axis=1))


KINDS = {"Float32": "<f4", "Float64": "<f8", "Int32": "<i4", "UInt8": "u1", "Int64": "<i8"}


def read_frame(path, needed):
    """The arrays of a file written by io::VtkPolyData, by section and name. `needed`: arrays that it must have"""
    if os.path.getsize(path) > MOST_BYTES:
        raise Refused(f"{path}: has {os.path.getsize(path) / 1e6:.0f} MB, at most {MOST_BYTES / 1e6:.0f} MB are read")
    with open(path, "rb") as file:
        text = file.read()
    begin = text.find(b"_", text.find(b"<AppendedData")) + 1
    arrays, section = {}, ""
    try:
        for tag, name in re.findall(rb"<(PointData|Points|Polys|Lines|Verts|CellData|DataArray)\b([^>]*)>", text[:begin]):
            if tag != b"DataArray":
                section = tag.decode()
                continue
            of = dict((k.decode(), v.decode()) for k, v in re.findall(rb'(\w+)="([^"]*)"', name))
            at = begin + int(of["offset"])
            size = int.from_bytes(text[at:at + 8], "little")
            values = np.frombuffer(text, KINDS[of["type"]], size // np.dtype(KINDS[of["type"]]).itemsize, at + 8)
            components = int(of.get("NumberOfComponents", "1"))
            arrays[section, of["Name"]] = values.reshape(-1, components) if components > 1 else values
    except (KeyError, ValueError):
        raise Refused(f"{path}: is incomplete, or not a frame of HILDA") from None
    for section, name in needed:
        if (section, name) not in arrays:
            raise Refused(f"{path}: is not a frame of HILDA: {section} has no array {name}")
    return arrays


def frames_of(folder):
    """The times and files of the parts of run.pvd: {part: [(t, path), ...]}"""
    path = os.path.join(folder, "run.pvd")
    parts = {}
    if not os.path.isfile(path):
        return parts
    try:
        entries = xml.etree.ElementTree.parse(path).getroot().iter("DataSet")
        frames = [(float(entry.attrib["timestep"]), entry.attrib["file"]) for entry in entries]
    except (xml.etree.ElementTree.ParseError, KeyError, ValueError) as error:
        raise Refused(f"{path}: is not a list of frames: {error}") from None
    for t, file in frames:
        part = re.fullmatch(r"(?:vtk/)?([a-z]+)[^/]*", file)  # in the folder
        if part and os.path.isfile(os.path.join(folder, file)):
            parts.setdefault(part[1], []).append((t, os.path.join(folder, file)))
    return parts


def folder_of_grains(folder):
    """The grains of a co-simulation have a folder in that of the mechanism."""
    below = os.path.join(folder, "grains")
    return below if os.path.isfile(os.path.join(below, "run.pvd")) else folder
