#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws docs/theory/figures/mesh-contacts.svg: the regions in which the inside of a triangle, an edge or a vertex of a mesh
owns the contact with a particle whose centre is there.

    mesh_contacts.py            writes the drawing
    mesh_contacts.py --check    compares it with the file; exit code 1 if they differ

The regions are not drawn by hand. They are the polygons of the conditions in granular/core/surfaces/mesh_view.hpp, which are
half-planes in a section of the mesh.
"""
import math
import pathlib
import sys

FILE = pathlib.Path(__file__).with_name("mesh-contacts.svg")
FACE_A, FACE_B, EDGE, VERTEX, BOTH = "#cfe3f5", "#d5ecd0", "#fbdcb5", "#e0d0ee", "#f6c9c9"
LINE, GRAIN, FORCE, HISTORY = "#222222", "#777777", "#b02a2a", "#1f5fa8"
WIDTH, HEIGHT, GAP = 300, 250, 20  # of a panel [px]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1]


def clipped(polygon, normal, offset=0.0):
    """The part of a convex polygon with normal · p >= offset"""
    out = []
    for p, q in zip(polygon, polygon[1:] + polygon[:1]):
        at_p, at_q = dot(normal, p) - offset, dot(normal, q) - offset
        if at_p >= 0:
            out.append(p)
        if (at_p > 0) != (at_q > 0) and at_p != at_q:
            s = at_p / (at_p - at_q)
            out.append((p[0] + s * (q[0] - p[0]), p[1] + s * (q[1] - p[1])))
    return out


def minus(a):
    return (-a[0], -a[1])


class Panel:
    """A panel with its origin in the middle, y upwards, lengths in px"""

    def __init__(self, drawing, column, line, title, low=-100.0):
        self.drawing, self.x0 = drawing, GAP + column * (WIDTH + GAP)
        self.y0, self.low = 30 + line * (HEIGHT + 55), low
        self.box = [(-WIDTH / 2, low), (WIDTH / 2, low), (WIDTH / 2, low + HEIGHT), (-WIDTH / 2, low + HEIGHT)]
        drawing.append(f'<text x="{self.x0}" y="{self.y0 - 9}" font-weight="bold">{title}</text>')

    def at(self, p):
        return f"{self.x0 + WIDTH / 2 + p[0]:.1f},{self.y0 + HEIGHT + self.low - p[1]:.1f}"

    def polygon(self, points, fill, stroke="none"):
        if points:
            self.drawing.append(f'<polygon points="{" ".join(map(self.at, points))}" fill="{fill}" stroke="{stroke}"/>')

    def path(self, points, colour=LINE, width=1.0, dash="", arrow=False):
        more = f' stroke-dasharray="{dash}"' if dash else ""
        more += f' marker-end="url(#arrow{colour[1:]})"' if arrow else ""
        self.drawing.append(f'<polyline points="{" ".join(map(self.at, points))}" fill="none" stroke="{colour}" '
                            f'stroke-width="{width}"{more}/>')

    def circle(self, p, radius, fill="none", stroke=GRAIN):
        x, y = self.at(p).split(",")
        self.drawing.append(f'<circle cx="{x}" cy="{y}" r="{radius}" fill="{fill}" stroke="{stroke}" stroke-width="1.3"/>')

    def text(self, p, words, anchor="middle", colour=LINE):
        x, y = self.at(p).split(",")
        for line, part in enumerate(words.split("\n")):
            self.drawing.append(f'<text x="{x}" y="{float(y) + 15 * line:.1f}" text-anchor="{anchor}" fill="{colour}">{part}</text>')

    def grain(self, p, radius, *closest):
        """A particle with the closest points at which it has contacts, and the normals"""
        self.circle(p, radius)
        self.circle(p, 1.6, GRAIN)
        for q in closest:
            self.circle(q, 2.6, FORCE, FORCE)
            self.path([q, p], FORCE, 1.2, arrow=True)

    def frame(self):
        self.polygon(self.box, "none", "#999999")


def normals(a, b):
    """Of two faces that leave the edge at the origin in the directions a, to the left, and b, to the right; the particles are
    above"""
    return (a[1], -a[0]), (-b[1], b[0])


def direction(angle):
    return (math.cos(math.radians(angle)), math.sin(math.radians(angle)))


def convex(drawing):
    panel = Panel(drawing, 0, 0, "a: convex edge", -110)
    a, b = direction(225), direction(-45)
    n_a, n_b = normals(a, b)
    # inside of a face: in front of it and not outside across the edge; edge: outside of both
    panel.polygon(clipped(clipped(panel.box, n_a), a), FACE_A)
    panel.polygon(clipped(clipped(panel.box, n_b), b), FACE_B)
    panel.polygon(clipped(clipped(panel.box, minus(a)), minus(b)), EDGE)
    draw_faces(panel, a, b)
    for n in (n_a, n_b):
        panel.path([(0, 0), (150 * n[0], 150 * n[1])], LINE, 1, "5,4")
    for p, q in (((-92, -22), foot((-92, -22), n_a)), ((0, 42), (0, 0)), ((92, -22), foot((92, -22), n_b))):
        panel.grain(p, math.hypot(p[0] - q[0], p[1] - q[1]) + 5, q)
    panel.text((-105, 60), "inside of A")
    panel.text((105, 60), "inside of B")
    panel.text((0, 118), "edge")
    panel.text((-52, -78), "A")
    panel.text((52, -78), "B")
    panel.frame()


def foot(p, n):
    """The closest point of the plane through the origin"""
    h = dot(p, n)
    return (p[0] - h * n[0], p[1] - h * n[1])


def draw_faces(panel, a, b):
    """The faces, cut at the box, and the side of the body"""
    left, right = reach(panel, a), reach(panel, b)
    body = [left, (0, 0), right]
    low_left = [] if abs(left[1] - panel.low) < 1e-6 else [(-WIDTH / 2, panel.low)]
    low_right = [] if abs(right[1] - panel.low) < 1e-6 else [(WIDTH / 2, panel.low)]
    panel.polygon(body + low_right + low_left, "#e8e8e8")
    panel.path(body, LINE, 2.4)


def flat(drawing):
    panel = Panel(drawing, 1, 0, "b: edge in a flat face", -60)
    a, b = direction(180), direction(0)
    n_a, n_b = normals(a, b)
    panel.polygon(clipped(clipped(panel.box, n_a), a), FACE_A)
    panel.polygon(clipped(clipped(panel.box, n_b), b), FACE_B)
    draw_faces(panel, a, b)
    panel.path([(0, 0), (0, 190)], LINE, 1, "5,4")
    panel.grain((-70, 45), 50, (-70, 0))
    panel.grain((20, 45), 50, (20, 0))
    panel.text((-75, 140), "inside of A")
    panel.text((75, 140), "inside of B")
    panel.text((0, -25), "one contact, that of the plane")
    panel.frame()


def cross(u, v):
    return (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])


def negative(v):
    return tuple(-x for x in v)


def vertex(drawing):
    """Section parallel to the base of a pyramid of five faces, above its apex"""
    panel = Panel(drawing, 2, 0, "c: vertex of five triangles, from above", -125)
    height, drop, count = 42.0, 0.62, 5
    edges = []
    for k in range(count):
        d = direction(90 + 360 / count * k + (12 if k == 2 else 0))
        edges.append((d[0], d[1], -drop))

    def part(*normals):
        """n · p >= 0 for all normals n, in the section p = (x, y, height)"""
        polygon = panel.box
        for n in normals:
            polygon = clipped(polygon, (n[0], n[1]), -n[2] * height)
        return polygon

    across = []  # of face k, between the edges k and k + 1: planes across edge k and across edge k + 1, away from the face
    for k in range(count):
        e, f = edges[k], edges[(k + 1) % count]
        n = cross(e, f)
        across.append((cross(e, n), cross(n, f)))
    tints = ["#cfe3f5", "#d5ecd0", "#cdeaea", "#e7efc4", "#d9def5"]
    for k in range(count):
        panel.polygon(part(negative(across[k][0]), negative(across[k][1])), tints[k], "#888888")
    for k in range(count):  # outside of both faces of the edge, and in front of its end
        panel.polygon(part(across[k][0], across[k - 1][1], edges[k]), EDGE, "#888888")
    panel.polygon(part(*[negative(e) for e in edges]), VERTEX, "#888888")
    for k in range(count):
        e = edges[k]
        panel.path([(0, 0), reach(panel, e)], LINE, 2.2)
        middle = direction(90 + 360 / count * (k + 0.5))
        panel.text((104 * middle[0], 104 * middle[1] - 4), f"{k}")
        owner, beside = min(k, (k - 1) % count), (-e[1], e[0])
        panel.text((82 * e[0] + 12 * beside[0], 82 * e[1] + 12 * beside[1] - 4), f"{owner}", colour="#a05a00")
    panel.circle((0, 0), 3, LINE, LINE)
    panel.text((-12, 8), "0", colour="#5b2a86")
    panel.frame()


def reach(panel, d):
    """The end of a ray from the origin at the side of the panel"""
    limits = [(WIDTH / 2) / abs(d[0]) if abs(d[0]) > 1e-9 else 1e9,
              (panel.low + HEIGHT) / d[1] if d[1] > 1e-9 else 1e9, panel.low / d[1] if d[1] < -1e-9 else 1e9]
    return (min(limits) * d[0], min(limits) * d[1])


def concave(drawing):
    panel = Panel(drawing, 0, 1, "d: concave edge, more than 20 degrees", -60)
    a, b = direction(145), direction(35)
    n_a, n_b = normals(a, b)
    above_both = clipped(clipped(panel.box, n_a), n_b)
    panel.polygon(clipped(above_both, a), FACE_A)
    panel.polygon(clipped(above_both, b), FACE_B)
    panel.polygon(clipped(clipped(above_both, a), b), BOTH)
    draw_faces(panel, a, b)
    for n in (n_a, n_b):
        panel.path([(0, 0), reach(panel, n)], LINE, 1, "5,4")
    p = (0, 58)
    panel.grain(p, 54, foot(p, n_a), foot(p, n_b))
    panel.text((0, 150), "both: two contacts,")
    panel.text((0, 135), "each with its history")
    panel.text((-121, 116), "A only")
    panel.text((121, 116), "B only")
    panel.frame()


def smooth(drawing):
    panel = Panel(drawing, 1, 1, "e: concave edge, less than 20 degrees", -60)
    a, b = direction(171), direction(9)
    n_a, n_b = normals(a, b)
    above_both = clipped(clipped(panel.box, n_a), n_b)
    closer = (n_b[0] - n_a[0], n_b[1] - n_a[1])  # height above B less that above A
    panel.polygon(clipped(clipped(above_both, a), closer), FACE_A)
    panel.polygon(clipped(clipped(above_both, b), minus(closer)), FACE_B)
    draw_faces(panel, a, b)
    panel.path([(0, 0), (0, 190)], LINE, 1.4, "9,3,2,3")
    for n in (n_a, n_b):
        panel.path([(0, 0), reach(panel, n)], LINE, 0.8, "3,4")
    p = (-7, 74)
    panel.grain(p, 80, foot(p, n_a))
    panel.text((-95, 150), "A is closer")
    panel.text((95, 150), "B is closer")
    panel.text((0, -30), "one contact, that of the closer one")
    panel.frame()


def handing_over(drawing):
    panel = Panel(drawing, 2, 1, "f: the friction displacement u at an edge", -110)
    a, b = direction(190), direction(-38)
    n_a, n_b = normals(a, b)
    panel.polygon(clipped(clipped(panel.box, n_a), a), FACE_A)
    panel.polygon(clipped(clipped(panel.box, n_b), b), FACE_B)
    panel.polygon(clipped(clipped(panel.box, minus(a)), minus(b)), EDGE)
    draw_faces(panel, a, b)
    radius, depth = 34, 30
    for p, q in ((scaled(a, 78), None), ((0, 0), (0.33, 0.94)), (scaled(b, 84), None)):
        n = q or (n_a if p[0] < 0 else n_b)
        centre = (p[0] + depth * n[0], p[1] + depth * n[1])
        panel.grain(centre, radius, p)
        t = (n[1], -n[0])
        panel.path([p, (p[0] + 24 * t[0], p[1] + 24 * t[1])], HISTORY, 2.2, arrow=True)
    panel.text((-78, 75), "u of A")
    panel.text((22, 80), "u of the edge")
    panel.text((108, 20), "u of B")
    panel.text((0, 122), "the length of u stays, its direction")
    panel.text((0, 107), "turns into the new tangent plane")
    panel.frame()


def scaled(a, s):
    return (s * a[0], s * a[1])


def drawing():
    wide, high = 3 * WIDTH + 4 * GAP, 2 * (HEIGHT + 55)
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide} {high}" width="{wide}" height="{high}" '
             'font-family="DejaVu Sans, Helvetica, Arial, sans-serif" font-size="12.5">',
             '<!-- Written by docs/theory/figures/mesh_contacts.py -->',
             *(f'<defs><marker id="arrow{colour[1:]}" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="6" markerHeight="6" '
               f'orient="auto"><path d="M0,0 L8,4 L0,8 z" fill="{colour}"/></marker></defs>' for colour in (FORCE, HISTORY)),
             f'<rect width="{wide}" height="{high}" fill="white"/>']
    for panel in (convex, flat, vertex, concave, smooth, handing_over):
        panel(parts)
    return "\n".join(part for part in parts if part) + "\n</svg>\n"


def main():
    text = drawing()
    if "--check" not in sys.argv:
        FILE.write_text(text, encoding="utf-8")
        return 0
    if FILE.exists() and FILE.read_text(encoding="utf-8") == text:
        return 0
    print(f"docs/theory/figures/{FILE.name} is out of date; run: python3 docs/theory/figures/mesh_contacts.py")
    return 1


if __name__ == "__main__":
    sys.exit(main())
