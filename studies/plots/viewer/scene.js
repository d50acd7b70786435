// SPDX-License-Identifier: GPL-3.0-or-later
// The bodies, joints, lines, contacts, grains and boundaries of a page, as objects of three.js.
'use strict';

const COLOURS = [0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7, 0xe69f00, 0x56b4e9, 0x8c6bb1, 0x66a61e];
const GROUND = 0xb0b0b0;

// The numbers of a base64 text
function numbers(text, Type) {
  const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));
  return new Type(bytes.buffer);
}

// Colours from blue over green and yellow to red, for s from 0 to 1
function scale(s) {
  const c = Math.min(1, Math.max(0, s));
  return new THREE.Color().setHSL(0.66 * (1 - c), 0.85, 0.3 + 0.25 * Math.sin(Math.PI * c) + 0.1);
}

// The index of the last time that is at most t, and the part of the interval that has passed
function interval(times, t) {
  let low = 0, high = times.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle; else high = middle;
  }
  const length = times[high] - times[low];
  return { k: low, next: high, s: length > 0 ? Math.min(1, Math.max(0, (t - times[low]) / length)) : 0 };
}

// The values of a column, decoded once
function values_of(column) {
  if (!column.decoded) column.decoded = Float64Array.from(numbers(column.values, Float32Array), v => v + column.offset);
  return column.decoded;
}
function times_of(table) {
  return table.decoded = table.decoded || numbers(table.times, Float64Array);
}

// Two groups of triangles; the second one has a darker tone
function geometry_of(mesh) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(numbers(mesh.points, Float32Array), 3));
  const triangles = numbers(mesh.triangles, Uint32Array);
  geometry.setIndex(new THREE.BufferAttribute(triangles, 1));
  geometry.addGroup(0, 3 * mesh.dark, 0);
  geometry.addGroup(3 * mesh.dark, triangles.length - 3 * mesh.dark, 1);
  const drawn = mesh.flat ? geometry.toNonIndexed() : geometry; // a normal for each face
  drawn.computeVertexNormals();
  return drawn;
}

// The edges at which faces meet at more than 20 degrees
function edges_of(geometry) {
  const material = new THREE.LineBasicMaterial({ color: 0x333333, transparent: true, opacity: 0.6 });
  return new THREE.LineSegments(new THREE.EdgesGeometry(geometry, 20), material);
}

// A helix from 0 to 1 along y, for springs
class Helix extends THREE.Curve {
  getPoint(s) {
    const turn = 2 * Math.PI * 8 * s, r = s > 0.08 && s < 0.92 ? 1 : 0;
    return new THREE.Vector3(r * Math.cos(turn), s, r * Math.sin(turn));
  }
}

// A model: its bodies have poses, between which it interpolates
class Mechanism {
  constructor(data, size) {
    this.data = data;
    this.size = size;
    this.object = new THREE.Group();
    this.times = numbers(data.times, Float64Array);
    this.poses = numbers(data.poses, Float32Array);
    this.groups = data.bodies.map(() => new THREE.Group());
    this.ground = new THREE.Group();
    this.object.add(this.ground, ...this.groups);
    const material = colour => new THREE.MeshLambertMaterial({ color: colour, side: THREE.DoubleSide });
    this.materials = data.bodies.map((_, k) => [material(COLOURS[k % COLOURS.length]), material(0)]);
    this.pickable = [];
    for (const mesh of data.meshes) this.add_mesh(mesh);
    const ball = new THREE.SphereBufferGeometry(0.009 * size, 12, 8);
    const joint_material = new THREE.MeshLambertMaterial({ color: 0x333333 });
    for (const joint of data.joints) {
      const point = new THREE.Mesh(ball, joint_material);
      point.position.fromArray(joint.point);
      this.group(joint.body).add(point);
    }
    this.lines = data.lines.map(line => this.make_line(line));
    this.arrows = data.contacts.map(contact => this.make_arrows(contact));
    this.force_scale = 0.25 * size / (data.largest_force || 1);
  }

  group(body) { return body < 0 ? this.ground : this.groups[body]; }

  add_mesh(mesh) {
    const geometry = geometry_of(mesh);
    const is_ground = mesh.body < 0;
    // The ground is seen from the side of its contacts only: what lies behind a wall is visible.
    const shared = { side: mesh.unbounded || is_ground ? THREE.FrontSide : THREE.DoubleSide };
    const grey = () => new THREE.MeshLambertMaterial({
      ...shared, color: GROUND, transparent: mesh.unbounded, opacity: mesh.unbounded ? 0.6 : 1, depthWrite: !mesh.unbounded });
    const material = mesh.unbounded || is_ground ? [grey(), grey()] : this.materials[mesh.body];
    const object = new THREE.Mesh(geometry, material);
    object.userData.body = mesh.body;
    if (mesh.flat)
      object.add(edges_of(geometry));
    this.group(mesh.body).add(object);
    if (!is_ground) this.pickable.push(object);
  }

  make_line(line) {
    const own = line.kind === 'bar' && line.body_i >= 0;
    const thickness = this.size * (line.kind === 'bar' ? 0.008 : 0.004);
    const colour = line.kind === 'spring' ? 0xb8860b : 0x555555;
    const material = own ? this.materials[line.body_i][0] : new THREE.MeshLambertMaterial({ color: colour });
    const geometry = line.kind === 'spring' ? new THREE.TubeBufferGeometry(new Helix(), 160, 0.16, 5)
                                            : new THREE.CylinderBufferGeometry(1, 1, 1, 10).translate(0, 0.5, 0);
    const object = new THREE.Mesh(geometry, material);
    object.userData.body = line.body_i;
    if (own) this.pickable.push(object);
    this.object.add(object);
    const radius = line.kind === 'spring' ? 3.5 * thickness : thickness;
    const [i, j] = [line.point_i, line.point_j].map(p => new THREE.Vector3().fromArray(p));
    return { line, object, radius, i, j };
  }

  make_arrows(contact) {
    const arrow = colour => {
      const group = new THREE.Group();
      const material = new THREE.MeshBasicMaterial({ color: colour, depthTest: false, transparent: true });
      const shaft = new THREE.Mesh(new THREE.CylinderBufferGeometry(0.5, 0.5, 1, 8).translate(0, 0.5, 0), material);
      const head = new THREE.Mesh(new THREE.ConeBufferGeometry(1.3, 3, 12).translate(0, -1.5, 0), material);
      group.add(shaft, head);
      shaft.renderOrder = head.renderOrder = 1; // over the bodies, inside of which the forces lie
      this.object.add(group);
      return { group, shaft, head };
    };
    return { values: numbers(contact.values, Float32Array), normal: arrow(0x1a7f37), friction: arrow(0xc51b7d) };
  }

  // Places the cylinder or helix between two points of the global frame
  static between(object, from, to, radius) {
    const along = new THREE.Vector3().subVectors(to, from), length = along.length();
    object.visible = length > 0;
    object.position.copy(from);
    if (length > 0) object.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), along.divideScalar(length));
    object.scale.set(radius, Math.max(length, 1e-12), radius);
  }

  set_arrow(arrow, values, at, show) {
    const force = new THREE.Vector3(values[at], values[at + 1], values[at + 2]), size = force.length();
    const length = this.force_scale * size;
    arrow.group.visible = show && length > 1e-4 * this.size;
    if (!arrow.group.visible) return;
    const radius = 0.006 * this.size;
    arrow.group.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), force.divideScalar(size));
    arrow.shaft.scale.set(radius, length, radius);
    arrow.head.position.set(0, length, 0);
    arrow.head.scale.setScalar(Math.min(radius, length / 3));
  }

  show(t, forces) {
    const { k, next, s } = interval(this.times, t), bodies = this.groups.length, P = this.poses;
    const q = new THREE.Quaternion(), end = new THREE.Quaternion();
    this.groups.forEach((group, b) => {
      const i = 7 * (k * bodies + b), j = 7 * (next * bodies + b);
      group.position.set(P[i] + s * (P[j] - P[i]), P[i + 1] + s * (P[j + 1] - P[i + 1]), P[i + 2] + s * (P[j + 2] - P[i + 2]));
      q.set(P[i + 3], P[i + 4], P[i + 5], P[i + 6]);
      group.quaternion.copy(q.slerp(end.set(P[j + 3], P[j + 4], P[j + 5], P[j + 6]), s));
    });
    this.object.updateMatrixWorld(true);
    for (const line of this.lines)
      Mechanism.between(line.object, this.group(line.line.body_i).localToWorld(line.i.clone()),
                        this.group(line.line.body_j).localToWorld(line.j.clone()), line.radius);
    const node = s < 0.5 ? k : next;
    for (const contact of this.arrows) {
      const at = 9 * node, v = contact.values;
      for (const arrow of [contact.normal, contact.friction]) arrow.group.position.set(v[at], v[at + 1], v[at + 2]);
      this.set_arrow(contact.normal, v, at + 3, forces);
      this.set_arrow(contact.friction, v, at + 6, forces);
    }
  }

  colour_by(quantity, t) {
    const k = interval(this.times, t).k;
    this.materials.forEach(([light, dark], b) => {
      if (quantity === 'speed') light.color.copy(scale(this.speed(b, k) / (this.largest_speed() || 1)));
      else light.color.setHex(COLOURS[b % COLOURS.length]);
      dark.color.copy(light.color).multiplyScalar(0.55);
    });
  }

  // Speed of a body between two rows
  speed(b, k) {
    const bodies = this.groups.length, P = this.poses, last = this.times.length - 1;
    if (last < 1) return 0;
    const i = Math.min(k, last - 1), from = 7 * (i * bodies + b), to = from + 7 * bodies, dt = this.times[i + 1] - this.times[i];
    return dt > 0 ? Math.hypot(P[to] - P[from], P[to + 1] - P[from + 1], P[to + 2] - P[from + 2]) / dt : 0;
  }

  largest_speed() {
    if (this.largest === undefined) {
      this.largest = 0;
      for (let k = 0; k + 1 < this.times.length; ++k)
        for (let b = 0; b < this.groups.length; ++b) this.largest = Math.max(this.largest, this.speed(b, k));
    }
    return this.largest;
  }
}

// Particles as shaded discs with the depth of spheres. The positions of a frame are 16-bit numbers in the box of all frames.
class Grains {
  constructor(data) {
    this.data = data;
    this.times = numbers(data.times, Float64Array);
    this.frame = -1;
    this.geometry = new THREE.BufferGeometry();
    this.uniforms = {
      low: { value: new THREE.Vector3().fromArray(data.low) },
      span: { value: new THREE.Vector3().fromArray(data.high).sub(new THREE.Vector3().fromArray(data.low)) },
      pixels: { value: 500 }, by: { value: 0 }, largest_radius: { value: data.largest_radius },
      up: { value: new THREE.Vector3(0, 0, 1) },
    };
    const material = new THREE.ShaderMaterial({
      uniforms: this.uniforms, extensions: { fragDepth: true },
      vertexShader: `
        attribute float radius, value;
        uniform vec3 low, span, up;
        uniform float pixels, largest_radius;
        uniform int by;
        varying float quantity, r, depth;
        void main() {
          vec4 p = modelViewMatrix * vec4(low + span * position, 1.0);
          r = largest_radius * radius;
          depth = p.z;
          quantity = by == 0 ? value : by == 1 ? dot(position, up) : radius;
          gl_Position = projectionMatrix * p;
          gl_PointSize = max(1.5, 2.0 * pixels * projectionMatrix[1][1] * r / -p.z);
        }`,
      fragmentShader: `
        uniform mat4 projectionMatrix;
        varying float quantity, r, depth;
        vec3 scale(float s) {
          return clamp(vec3(1.5 * s - 0.1, 1.0 - 1.8 * abs(s - 0.5), 1.0 - 1.6 * s), 0.05, 0.95);
        }
        void main() {
          vec2 at = 2.0 * gl_PointCoord - 1.0;
          float outside = dot(at, at);
          if (outside > 1.0) discard;
          float z = sqrt(1.0 - outside);
          float light = 0.4 + 0.6 * max(0.0, dot(vec3(at.x, -at.y, z), vec3(0.33, 0.5, 0.8)));
          gl_FragColor = vec4(light * scale(quantity), 1.0);
          #ifdef GL_EXT_frag_depth
          vec4 clip = projectionMatrix * vec4(0.0, 0.0, depth + r * z, 1.0);
          gl_FragDepthEXT = 0.5 * clip.z / clip.w + 0.5;
          #endif
        }`,
    });
    this.object = new THREE.Points(this.geometry, material);
    this.object.frustumCulled = false;
  }

  index(t) {
    const { k, next, s } = interval(this.times, t);
    return s > 0.999 ? next : k;
  }

  values_of(k) {
    const frame = this.data.frames[k];
    if (!frame.decoded)
      frame.decoded = { position: numbers(frame.position, Uint16Array), value: numbers(frame.value, Uint16Array),
                        radius: numbers(frame.radius || this.data.radius, Uint16Array),
                        id: numbers(frame.id || this.data.id, Int32Array) };
    return frame.decoded;
  }

  show(t) {
    const k = this.index(t);
    if (k === this.frame) return;
    this.frame = k;
    const { position, value, radius } = this.values_of(k);
    this.geometry.setAttribute('position', new THREE.BufferAttribute(position, 3, true));
    this.geometry.setAttribute('value', new THREE.BufferAttribute(value, 1, true));
    this.geometry.setAttribute('radius', new THREE.BufferAttribute(radius, 1, true));
    this.geometry.setDrawRange(0, value.length);
  }

  particle(n) {
    const { position, value, radius, id } = this.values_of(this.frame), { low, span } = this.uniforms;
    const at = c => low.value.getComponent(c) + span.value.getComponent(c) * position[3 * n + c] / 65535;
    return { id: id[n], r: [at(0), at(1), at(2)], radius: this.data.largest_radius * radius[n] / 65535,
             speed: this.data.largest_value * value[n] / 65535 };
  }

  // The particle nearest to the viewer under a point of the canvas, in normalised device coordinates; -1: none
  pick(ndc, camera, aspect) {
    const M = new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse).elements;
    const { position, radius } = this.values_of(this.frame), f = camera.projectionMatrix.elements[5];
    const low = this.uniforms.low.value, span = this.uniforms.span.value;
    let best = -1, nearest = Infinity;
    for (let n = 0; n < radius.length; ++n) {
      const x = low.x + span.x * position[3 * n] / 65535, y = low.y + span.y * position[3 * n + 1] / 65535,
            z = low.z + span.z * position[3 * n + 2] / 65535;
      const w = M[3] * x + M[7] * y + M[11] * z + M[15];
      if (w <= 0 || w >= nearest) continue;
      const dx = ((M[0] * x + M[4] * y + M[8] * z + M[12]) / w - ndc.x) * aspect;
      const dy = (M[1] * x + M[5] * y + M[9] * z + M[13]) / w - ndc.y;
      if (Math.hypot(dx, dy) <= f * this.data.largest_radius * radius[n] / 65535 / w) { best = n; nearest = w; }
    }
    return best;
  }
}

// Boundaries of a granular case: a mesh for each frame, of which equal ones are stored once
class Boundaries {
  constructor(data) {
    this.times = numbers(data.times, Float64Array);
    this.mesh_of = data.mesh_of;
    this.object = new THREE.Group();
    this.meshes = data.meshes.map(mesh => {
      const geometry = geometry_of(mesh);
      const material = new THREE.MeshLambertMaterial({
        color: GROUND, side: THREE.DoubleSide, transparent: true, opacity: 0.25, depthWrite: false });
      const object = new THREE.Mesh(geometry, [material, material]);
      object.add(edges_of(geometry));
      this.object.add(object);
      return object;
    });
  }
  show(t) {
    const { k, next, s } = interval(this.times, t), shown = this.mesh_of[s > 0.999 ? next : k];
    this.meshes.forEach((mesh, n) => { mesh.visible = n === shown; });
  }
}
