// SPDX-License-Identifier: GPL-3.0-or-later
// The page: camera, controls, selection. `viewer` is its interface for scripts.
'use strict';

const element = id => document.getElementById(id);
const SPEEDS = [0.01, 0.03, 0.1, 0.3, 1, 3, 10, 30];
const COLOUR_NAMES = { body: 'body', speed: 'speed', height: 'height', radius: 'radius' };

const viewer = { ready: false, t: 0, playing: false, rate: 1, errors: [] };
window.addEventListener('error', event => fail(event.message));

function fail(message) {
  viewer.errors.push(String(message));
  const box = element('failure') || document.createElement('div');
  box.id = 'failure';
  box.textContent = viewer.errors.join('\n');
  element('space').append(box);
}

// The pages are opened without a server: three.js only, no other files
function start(data) {
  const space = element('space');
  const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
  renderer.setPixelRatio(window.devicePixelRatio || 1);
  renderer.setClearColor(0xffffff);
  space.prepend(renderer.domElement);

  const up = new THREE.Vector3().fromArray(data.up);
  const low = new THREE.Vector3().fromArray(data.low), high = new THREE.Vector3().fromArray(data.high);
  const centre = low.clone().add(high).multiplyScalar(0.5), size = low.distanceTo(high) || 1;
  const scene = new THREE.Scene();
  const camera = new THREE.PerspectiveCamera(35, 1, 1e-3 * size, 100 * size);
  camera.up.copy(up);
  const light = new THREE.DirectionalLight(0xffffff, 0.65);
  scene.add(new THREE.HemisphereLight(0xffffff, 0x9090a0, 0.55), light, camera);
  const controls = new THREE.OrbitControls(camera, renderer.domElement);

  const parts = [], tables = data.tables;
  let mechanism = null, grains = null;
  if (data.mechanism) parts.push(mechanism = new Mechanism(data.mechanism, size));
  if (data.grains) parts.push(grains = new Grains(data.grains));
  if (grains) grains.uniforms.up.value.copy(up);
  if (data.boundaries) parts.push(new Boundaries(data.boundaries));
  for (const part of parts) scene.add(part.object);
  const grid = new FloorGrid(low, high, up, data.floor), triad = new Triad(element('triad')), scale_bar = new ScaleBar(element('scale'));
  scene.add(grid.object);
  element('grid').textContent = `grid ${length_text(grid.spacing)}`;
  Object.assign(viewer, { camera, controls, grid, scale_bar });

  // The plane in which the smallest extent is normal to the view; else a view from above at an angle
  function look(from) {
    const span = high.clone().sub(low), across = new THREE.Vector3();
    const level = [0, 1, 2].filter(c => Math.abs(up.getComponent(c)) < 0.5);
    const [thin, other] = level.sort((a, b) => span.getComponent(a) - span.getComponent(b));
    const axis = c => new THREE.Vector3().setComponent(c, 1);
    if (from === 'default') {
      across.copy(axis(thin)).addScaledVector(up, 0.25);
      const sides = span.getComponent(other);
      across.addScaledVector(axis(other), span.getComponent(thin) < 0.25 * sides ? -0.2 : -0.75);
      if (thin === 1) across.setComponent(1, -Math.abs(across.y));
    } else if (from === 'top') across.copy(up).addScaledVector(axis(thin), 1e-3);
    else across.copy(axis({ x: 0, y: 1, z: 2 }[from[1]])).multiplyScalar(from[0] === '-' ? -1 : 1).addScaledVector(up, 1e-3);
    // The smallest distance from which all corners of the box are in the picture
    const z = across.normalize(), x = up.clone().cross(z).normalize(), y = z.clone().cross(x);
    const slope_y = Math.tan(0.5 * camera.fov * Math.PI / 180), slope_x = slope_y * camera.aspect;
    let distance = 0;
    for (let corner = 0; corner < 8; ++corner) {
      const p = new THREE.Vector3(...[0, 1, 2].map(c => (corner >> c & 1 ? high : low).getComponent(c))).sub(centre);
      distance = Math.max(distance, p.dot(z) + Math.max(Math.abs(p.dot(y)) / slope_y, Math.abs(p.dot(x)) / slope_x));
    }
    controls.target.copy(centre);
    camera.position.copy(centre).addScaledVector(z, 1.1 * (distance || size));
    controls.update();
    changed = true;
  }

  let changed = true;
  controls.addEventListener('change', () => { changed = true; });
  function resize() {
    const width = Math.max(1, space.clientWidth), height = Math.max(1, space.clientHeight);
    renderer.setSize(width, height);
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    if (grains) grains.uniforms.pixels.value = 0.5 * height * renderer.getPixelRatio();
    plots.forEach(plot => plot.draw(viewer.t));
    changed = true;
  }

  const first = data.times[0], last = data.times[1];
  const plots = [];
  function set_time(t) {
    viewer.t = Math.min(last, Math.max(first, t));
    element('time').value = viewer.t;
    element('clock').textContent = `${viewer.t.toFixed(4)} s`;
    changed = true;
  }

  function colours() {
    const names = mechanism && !grains ? ['body', 'speed'] : ['speed', 'height', 'radius'];
    for (const name of names) element('colour').add(new Option(COLOUR_NAMES[name], name));
    element('colour').onchange = () => { show_legend(); changed = true; };
  }
  function show_legend() {
    const by = element('colour').value, legend = element('legend');
    if (grains) grains.uniforms.by.value = { speed: 0, height: 1, radius: 2 }[by] || 0;
    const most = by === 'speed' ? (grains ? grains.data.largest_value : mechanism.largest_speed())
                                : by === 'radius' ? grains.data.largest_radius : high.dot(up);
    legend.hidden = by === 'body';
    if (legend.hidden) return;
    const colour = s => {
      if (!grains) return `#${scale(s).getHexString()}`;
      const part = v => Math.round(255 * Math.min(0.95, Math.max(0.05, v)));
      return `rgb(${part(1.5 * s - 0.1)},${part(1 - 1.8 * Math.abs(s - 0.5))},${part(1 - 1.6 * s)})`;
    };
    const stops = [0, 0.2, 0.4, 0.6, 0.8, 1].map(colour).join(',');
    const least = by === 'height' ? low.dot(up) : 0;
    const bar = `<span style="background:linear-gradient(to right,${stops})"></span>`;
    legend.innerHTML = `${COLOUR_NAMES[by]} ${number_text(least)}${bar}${number_text(most)} ${by === 'speed' ? 'm/s' : 'm'}`;
  }

  let selected = null;
  function show_selection() {
    const box = element('picked');
    if (!selected) return;
    const rows = [];
    const add = (name, value) => rows.push([name, value]);
    if (selected.body !== undefined) {
      const body = data.mechanism.bodies[selected.body];
      add('body', body);
      for (const table of tables)
        for (const column of table.columns)
          if (column.name.startsWith(`${body}.`)) {
            const value = values_of(column)[interval(times_of(table), viewer.t).k];
            add(column.name.slice(body.length + 1), `${number_text(value)} ${column.unit}`);
          }
    } else {
      const p = grains.particle(selected.particle);
      if (selected.id !== p.id) { // another frame may have another order
        const { id } = grains.values_of(grains.frame), n = id.indexOf(selected.id);
        if (n < 0) { box.textContent = `Particle ${selected.id} is not in this frame.`; return; }
        selected.particle = n;
        return show_selection();
      }
      add('particle', p.id);
      p.r.forEach((v, c) => add('xyz'[c], `${number_text(v)} m`));
      add('radius', `${number_text(p.radius)} m`);
      add('speed', `${number_text(p.speed)} m/s`);
    }
    const table = document.createElement('table');
    for (const cells of rows) {
      const line = table.insertRow();
      for (const cell of cells) line.insertCell().textContent = cell;
    }
    box.replaceChildren(table);
  }

  // Selects what is at a point of the canvas, in pixels. Returns the name of the body, the particle as 'particle ID', or ''.
  viewer.pick = (x, y) => {
    const ndc = new THREE.Vector2(2 * x / space.clientWidth - 1, 1 - 2 * y / space.clientHeight);
    camera.updateMatrixWorld();
    const ray = new THREE.Raycaster();
    ray.setFromCamera(ndc, camera);
    const hits = mechanism ? ray.intersectObjects(mechanism.pickable) : [];
    selected = null;
    if (hits.length) selected = { body: hits[0].object.userData.body };
    else if (grains) {
      const n = grains.pick(ndc, camera, camera.aspect);
      if (n >= 0) selected = { particle: n, id: grains.particle(n).id };
    }
    if (!selected) element('picked').textContent = 'Click a body or a particle.';
    show_selection();
    return !selected ? '' : selected.body !== undefined ? data.mechanism.bodies[selected.body] : `particle ${selected.id}`;
  };
  // The pixel of a point of the global frame
  viewer.project = (x, y, z) => {
    camera.updateMatrixWorld();
    const p = new THREE.Vector3(x, y, z).project(camera);
    return [0.5 * (p.x + 1) * space.clientWidth, 0.5 * (1 - p.y) * space.clientHeight];
  };
  // The position of a body in the picture
  viewer.position = name => mechanism.groups[data.mechanism.bodies.indexOf(name)].position.toArray();

  let down = null;
  renderer.domElement.addEventListener('mousedown', event => { down = [event.clientX, event.clientY]; });
  renderer.domElement.addEventListener('mouseup', event => {
    const box = renderer.domElement.getBoundingClientRect();
    const moved = down ? Math.hypot(event.clientX - down[0], event.clientY - down[1]) : Infinity;
    if (moved < 4) viewer.pick(event.clientX - box.left, event.clientY - box.top);
  });

  viewer.play = on => {
    viewer.playing = on;
    element('play').textContent = on ? 'Pause' : 'Play';
    if (on && viewer.t >= last) set_time(first);
  };
  viewer.set_time = set_time;
  // Only the picture and its time, for a video
  viewer.picture_only = () => {
    document.body.classList.add('picture');
    space.append(element('clock'));
    resize();
    look('default');
  };
  viewer.frames = 0;

  element('name').innerHTML = '<b></b><br><span></span>';
  element('name').firstChild.textContent = data.title;
  element('name').lastChild.textContent = data.text;
  element('time').min = first;
  element('time').max = last;
  element('time').oninput = event => { viewer.play(false); set_time(Number(event.target.value)); };
  element('play').onclick = () => viewer.play(!viewer.playing);
  for (const rate of SPEEDS) element('speed').add(new Option(`${rate} ×`, rate));
  // By default the animation takes about ten seconds, or its own time if that is 3 to 30 s
  const wanted = last - first >= 3 && last - first <= 30 ? 1 : (last - first) / 10;
  viewer.rate = SPEEDS.reduce((a, b) => Math.abs(Math.log(b / wanted)) < Math.abs(Math.log(a / wanted)) ? b : a);
  element('speed').value = viewer.rate;
  element('speed').onchange = event => { viewer.rate = Number(event.target.value); };
  for (const side of ['default', '+x', '-x', '+y', '-y', '+z', 'top']) element('side_of').add(new Option(side, side));
  element('side_of').onchange = event => look(event.target.value);
  element('forces').hidden = !(mechanism && mechanism.arrows.length);
  element('arrows').onchange = () => { changed = true; };
  function show_references() {
    const on = element('references').checked;
    grid.object.visible = on;
    element('triad').style.display = element('scale').style.display = on ? '' : 'none';
    changed = true;
  }
  element('references').onchange = event => { show_references(); event.target.blur(); };
  document.addEventListener('keydown', event => {
    if (['INPUT', 'SELECT', 'BUTTON'].includes(event.target.tagName)) return;
    if (event.key === 'g') element('references').click();
    else if (event.key === ' ') viewer.play(!viewer.playing);
    else if (event.key === 'ArrowRight') set_time(viewer.t + (last - first) / 200);
    else if (event.key === 'ArrowLeft') set_time(viewer.t - (last - first) / 200);
    else return;
    event.preventDefault();
  });

  function add_plot(name) {
    const plot = new Plot(tables, name, t => { viewer.play(false); set_time(t); });
    plots.push(plot);
    element('plots').append(plot.element);
    plot.draw(viewer.t);
  }
  const names = tables.flatMap(table => table.columns.map(c => c.name));
  element('add').hidden = !names.length;
  element('add').onclick = () => add_plot(names[0]);
  colours();
  show_legend();
  set_time(first);
  resize();
  look('default');
  for (const name of data.curves) add_plot(name);
  window.addEventListener('resize', resize);

  if (data.live) follow();
  // Loads the page again when the result has grown. Camera and time stay; at the end of the result they follow it.
  function follow() {
    const saved = JSON.parse(sessionStorage.getItem('hilda') || 'null');
    if (saved) {
      camera.position.fromArray(saved.position);
      controls.target.fromArray(saved.target);
      controls.update();
      set_time(saved.at_end ? last : saved.t);
      element('colour').value = saved.colour;
      element('references').checked = saved.references !== false;
      show_legend();
      show_references();
    }
    const timer = setInterval(async () => {
      let stamp;
      try {
        stamp = await (await fetch('stamp')).text();
      } catch (error) { // the server has ended
        clearInterval(timer);
        return;
      }
      if (stamp === data.live || viewer.playing) return;
      sessionStorage.setItem('hilda', JSON.stringify({ t: viewer.t, at_end: viewer.t >= last, position: camera.position.toArray(),
                                                       target: controls.target.toArray(), colour: element('colour').value,
                                                       references: element('references').checked }));
      location.reload();
    }, 1000);
  }

  let before = null;
  function frame(now) {
    requestAnimationFrame(frame);
    if (viewer.playing && before !== null) {
      set_time(viewer.t + viewer.rate * (now - before) / 1000);
      if (viewer.t >= last) viewer.play(false);
    }
    before = now;
    if (!changed) return;
    changed = false;
    for (const part of parts) part.show(viewer.t, element('arrows').checked);
    if (mechanism && !grains) mechanism.colour_by(element('colour').value, viewer.t);
    light.position.copy(camera.position).addScaledVector(up, size);
    light.target.position.copy(centre);
    light.target.updateMatrixWorld();
    renderer.render(scene, camera);
    triad.draw(camera);
    scale_bar.draw(camera, controls.target, space.clientHeight);
    for (const plot of plots) if (!plot.removed) plot.draw(viewer.t);
    show_selection();
    ++viewer.frames;
    viewer.ready = true;
  }
  frame(null);
}

try {
  start(JSON.parse(element('data').textContent));
} catch (error) {
  fail(error.message);
}
