// SPDX-License-Identifier: GPL-3.0-or-later
// The floor grid, the directions of the axes and the scale of a page.
'use strict';

// The largest of 1, 2 or 5 times a power of ten that is at most x
function round_length(x) {
  const power = 10 ** Math.floor(Math.log10(x) + 1e-9);
  return power * [5, 2, 1].find(m => m * power <= x * (1 + 1e-9));
}

// 0.2 m, 20 mm, 5 km
function length_text(metres) {
  const [unit, name] = metres >= 1000 ? [1000, 'km'] : metres >= 0.1 ? [1, 'm'] : metres >= 1e-4 ? [1e-3, 'mm'] : [1e-6, 'µm'];
  return `${Number((metres / unit).toPrecision(6))} ${name}`;
}

// A grid normal to `up`, whose lines are at the multiples of its spacing. It covers the box from low to high with a margin, in
// which it fades.
class FloorGrid {
  constructor(low, high, up, height) {
    const size = low.distanceTo(high);
    this.spacing = round_length(size / 8);
    const normal = [0, 1, 2].find(c => Math.abs(up.getComponent(c)) > 0.5), [a, b] = [(normal + 1) % 3, (normal + 2) % 3];
    const level = height * Math.sign(up.getComponent(normal));
    const centre = c => 0.5 * (low.getComponent(c) + high.getComponent(c));
    const radius = c => 0.5 * (high.getComponent(c) - low.getComponent(c)) + 0.6 * size;
    const positions = [], colours = [];
    const vertex = (ca, xa, cb, xb, strength) => {
      const p = [0, 0, 0];
      p[ca] = xa, p[cb] = xb, p[normal] = level;
      positions.push(...p);
      // 1 in the middle, 0 on an ellipse within the ends of the lines
      const outside = Math.hypot((xa - centre(ca)) / radius(ca), (xb - centre(cb)) / radius(cb));
      const shade = strength * Math.min(1, Math.max(0, 2.2 * (1 - outside)));
      colours.push(1 - 1.05 * shade, 1 - 1.0 * shade, 1 - 0.9 * shade);
    };
    const lines = (across, along) => {
      const multiples = c => {
        const first = Math.ceil((centre(c) - radius(c)) / this.spacing), last = Math.floor((centre(c) + radius(c)) / this.spacing);
        return Array.from({ length: last - first + 1 }, (_, k) => first + k);
      };
      for (const k of multiples(across))
        for (const l of multiples(along).slice(0, -1))
          for (const end of [l, l + 1])
            vertex(across, k * this.spacing, along, end * this.spacing, k % 5 === 0 ? 0.2 : 0.12);
    };
    lines(a, b);
    lines(b, a);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.Float32BufferAttribute(positions, 3));
    geometry.setAttribute('color', new THREE.Float32BufferAttribute(colours, 3));
    this.object = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ vertexColors: THREE.VertexColors }));
  }
}

// The directions of the global axes as the camera sees them, without perspective. The axis nearest to the viewer is on top.
class Triad {
  constructor(svg) {
    this.svg = svg;
    this.axes = [['x', '#c0392b'], ['y', '#2e8b57'], ['z', '#2463b0']].map(([name, colour]) => {
      const group = document.createElementNS('http://www.w3.org/2000/svg', 'g');
      const add = (kind, attributes) => {
        const part = document.createElementNS('http://www.w3.org/2000/svg', kind);
        for (const key of Object.keys(attributes)) part.setAttribute(key, attributes[key]);
        group.append(part);
        return part;
      };
      const line = add('line', { x1: 0, y1: 0, stroke: colour, 'stroke-width': 2, 'stroke-linecap': 'round' });
      const head = add('path', { fill: colour });
      const label = add('text', { fill: colour, 'text-anchor': 'middle', 'dominant-baseline': 'central' });
      label.textContent = name;
      return { name, group, line, head, label };
    });
  }

  draw(camera) {
    const turn = camera.quaternion.clone().conjugate();
    this.axes.forEach((axis, c) => { axis.direction = new THREE.Vector3().setComponent(c, 1).applyQuaternion(turn); });
    for (const { group, line, head, label, direction } of [...this.axes].sort((p, q) => p.direction.z - q.direction.z)) {
      const [x, y] = [direction.x, -direction.y], length = Math.hypot(x, y), [u, v] = length > 0 ? [x / length, y / length] : [0, 0];
      const tip = 34, base = Math.max(0, tip * length - 8), wide = 3.5; // pixels
      line.setAttribute('x2', base * u);
      line.setAttribute('y2', base * v);
      head.setAttribute('d', `M${tip * x},${tip * y} L${base * u - wide * v},${base * v + wide * u} ` +
                             `L${base * u + wide * v},${base * v - wide * u} Z`);
      // The label of an axis along the view is beside its tip.
      label.setAttribute('x', tip * x + 8 * (length > 0.2 ? u : 1));
      label.setAttribute('y', tip * y + 8 * (length > 0.2 ? v : 1));
      this.svg.append(group);
    }
  }
}

// A bar with its length in the plane normal to the view through the target of the camera
class ScaleBar {
  constructor(element) {
    this.element = element;
    [this.text, this.bar] = element.children;
  }

  draw(camera, target, height) {
    const distance = camera.position.distanceTo(target);
    const pixels_per_metre = height / (2 * distance * Math.tan(0.5 * camera.fov * Math.PI / 180));
    this.metres = round_length(130 / pixels_per_metre);
    this.text.textContent = length_text(this.metres);
    this.bar.style.width = `${this.metres * pixels_per_metre}px`;
  }
}
