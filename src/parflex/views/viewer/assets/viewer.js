// The robot of a result, moved by its data. K3D draws; this file says where everything is.
// All lengths in metres. Arrays are (instants, …) in C order; platform quantities in platform axes.

const { meta, array } = await payload();
const element = (id) => document.getElementById(id);
const plates = Object.fromEntries(
  Object.entries(meta.plates).map(([name, id]) => [name, K3D.getObjectById(id)]),
);
const parts = meta.parts.map((part) => ({ ...part, ids: part.ids.map((id) => K3D.getObjectById(id)) }));
const count = meta.instants;
const state = {
  time: meta.start, playing: meta.playing, speed: meta.speed, scale: meta.scale, colouring: meta.colouring,
  mode: 0, phase: 0, legs: true, forces: true, frames: 0, firstPicture: null,
  swing: 0, amplitude: 1,
};

// --- data between the instants

function lookup(time) {
  const times = array.time;
  let low = 0, high = count - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle; else high = middle;
  }
  if (count === 1) return { i: 0, j: 0, f: 0 };
  const f = (time - times[low]) / (times[high] - times[low]);
  if (f >= 1) return { i: high, j: high, f: 0 };
  return { i: low, j: high, f: Math.max(0, f) };
}

function values(name, { i, j, f }) {
  if (meta.swings.length) return swung(name);
  const all = array[name], width = all.length / count;
  const out = new Float64Array(width);
  for (let k = 0; k < width; k++) {
    const a = all[i * width + k];
    out[k] = f === 0 ? a : a + f * (all[j * width + k] - a);
  }
  return out;
}

// --- vectors

const add = (a, b, s = 1) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const norm = (a) => Math.hypot(a[0], a[1], a[2]);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const row3 = (all, k) => [all[3 * k], all[3 * k + 1], all[3 * k + 2]];
const unit = (a) => { const n = norm(a); return n > 0 ? [a[0] / n, a[1] / n, a[2] / n] : [0, 0, 1]; };

function turned(R, v) {
  return [0, 3, 6].map((r) => R[r] * v[0] + R[r + 1] * v[1] + R[r + 2] * v[2]);
}

function put(object, columns, place) {
  object.matrixAutoUpdate = false;
  const [x, y, z] = columns;
  object.matrix.set(
    x[0], y[0], z[0], place[0], x[1], y[1], z[1], place[1], x[2], y[2], z[2], place[2], 0, 0, 0, 1,
  );
  object.matrixWorldNeedsUpdate = true;
}

// unit solids have their axis along z: cylinders from 0 to 1, the others about 0
function along(object, place, direction, width, length) {
  const z = unit(direction);
  const x = unit(cross(Math.abs(z[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0], z));
  const y = cross(z, x);
  put(object, [x.map((c) => width * c), y.map((c) => width * c), z.map((c) => length * c)], place);
}

// rings of radius `width` about a curve, across it; one at a point that is there twice is as the one before
function sweep(geometry, curve, width) {
  const position = geometry.attributes.position, normal = geometry.attributes.normal;
  const sides = position.count / curve.length, chord = unit(add(curve.at(-1), curve[0], -1));
  const x = unit(cross(Math.abs(chord[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0], chord));
  curve.forEach((point, k) => {
    const way = add(curve[Math.min(k + 1, curve.length - 1)], curve[Math.max(k - 1, 0)], -1);
    const z = norm(way) > 0 ? unit(way) : chord, u = unit(add(x, z, -dot(x, z))), v = cross(z, u);
    for (let s = 0; s < sides; s++) {
      const angle = (2 * Math.PI * s) / sides;
      const out = add(u.map((c) => c * Math.cos(angle)), v, Math.sin(angle));
      position.setXYZ(k * sides + s, ...add(point, out, width));
      normal?.setXYZ(k * sides + s, ...out);
    }
  });
  position.needsUpdate = true;
  if (normal) normal.needsUpdate = true;
  geometry.computeBoundingSphere();
}

// --- the platform: modes times their coordinates

function bending(q) {
  const shapes = array.shapes, nodes = array.nodes.length;
  const bend = new Float64Array(nodes);
  for (let k = 0; k < q.length; k++) {
    for (let n = 0; n < nodes; n++) bend[n] += q[k] * shapes[k * nodes + n];
  }
  return bend;
}

function vonMises(q) {
  const stress = array.stress, all = array.nodes.length / 3, out = new Float64Array(all);
  for (let n = 0; n < all; n++) {
    const s = new Float64Array(6);
    for (let k = 0; k < q.length; k++) {
      for (let c = 0; c < 6; c++) s[c] += q[k] * stress[(k * all + n) * 6 + c];
    }
    const [xx, yy, zz, xy, yz, xz] = s;
    out[n] = Math.sqrt(
      0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * (xy ** 2 + yz ** 2 + xz ** 2),
    );
  }
  return out;
}

const colourings = {
  deflection: (q, bend, n) => bend[3 * n + 2],
  magnitude: (q, bend, n) => Math.hypot(bend[3 * n], bend[3 * n + 1], bend[3 * n + 2]),
  stress: (q, bend, n, found) => found[n],
  plain: () => 0,
};

function drawPlatform(place, R, q, scale, largest) {
  const plate = plates[state.colouring];
  for (const each of Object.values(plates)) each.visible = each === plate;
  const bend = bending(q), nodes = array.nodes;
  const position = plate.geometry.attributes.position;
  for (let n = 0; n < nodes.length; n++) position.array[n] = nodes[n] + scale * bend[n];
  position.needsUpdate = true;
  const found = state.colouring === "stress" ? vonMises(q) : null;
  const colour = plate.geometry.attributes.uv ?? plate.geometry.attributes.attributes;
  if (colour) {
    const { low, high } = range(largest);
    const value = colourings[state.colouring];
    for (let n = 0; n < nodes.length / 3; n++) {
      colour.setX(n, Math.min(1, Math.max(0, (value(q, bend, n, found) - low) / (high - low))));
    }
    colour.needsUpdate = true;
  }
  if (plate.geometry.index) plate.geometry.computeVertexNormals();
  put(plate, [0, 1, 2].map((c) => [R[c], R[3 + c], R[6 + c]]), place);
  return bend;
}

function range(largest) {
  const { low, high } = meta.colourings[state.colouring];
  if (largest === null) return { low, high };
  return { low: low < 0 ? -largest : 0, high: largest };
}

// --- the legs and the forces

function stretchedPaths(now, R, scale) {
  const points = values("leg_path", now);
  if (array.leg_deformation) {
    const bent = values("leg_deformation", now);
    return points.map((c, k) => c + (scale - 1) * bent[k]);
  }
  const share = values("leg_share", now);
  const bend = values("attachment_deformation", now);
  for (let p = 0; p < meta.paths; p++) {
    const more = turned(R, row3(bend, meta.ends[p])).map((c) => (scale - 1) * c);
    for (let s = 0; s < meta.stations; s++) {
      const at = p * meta.stations + s;
      for (let c = 0; c < 3; c++) points[3 * at + c] += share[at] * more[c];
    }
  }
  return points;
}

const placers = {
  link(part, points) {
    const from = row3(points, part.from), way = add(row3(points, part.to), from, -1);
    along(part.ids[0], from, way, part.width, part.length ?? Math.max(norm(way), 1e-9));
  },
  tube(part, points) {
    const curve = [];
    for (let k = part.from; k <= part.to; k++) curve.push(row3(points, k));
    sweep(part.ids[0].geometry, curve, part.width);
  },
  pin(part, points, axes) {
    const axis = unit(row3(axes, part.at));
    along(part.ids[0], add(row3(points, part.at), axis, -0.5 * part.length), axis, part.width, part.length);
  },
  solid(part, points, axes) {
    along(part.ids[0], row3(points, part.at), row3(axes, part.at), part.width, part.width);
  },
  borne(part) {
    put(part.ids[0], part.columns, add(part.place, part.moved, swungBy().real));
  },
  carried(part, points, axes, now) {
    const R = values("base_rotation", now), base = values("base_position", now);
    const [x, y, z, place] = [0, 1, 2, 3].map((c) => turned(R, [0, 4, 8].map((r) => part.place[r + c])));
    put(part.ids[0], [x, y, z], add(base, place));
  },
};

function drawLegs(now, R, scale) {
  if (!meta.paths) return;
  const points = stretchedPaths(now, R, scale), axes = values("leg_axis", now);
  for (const part of parts) placers[part.kind]?.(part, points, axes, now);
}

function drawForces(now, R, scale) {
  if (!array.contact_forces) return;
  const forces = values("contact_forces", now), places = values("attachment_position", now);
  const bend = values("attachment_deformation", now);
  for (const part of parts.filter((each) => each.kind === "arrow")) {
    const force = turned(R, row3(forces, part.at)), length = meta.metresPerNewton * norm(force);
    const from = add(row3(places, part.at), turned(R, row3(bend, part.at)), scale - 1);
    const [shaft, head] = part.ids, tip = Math.min(length, 4 * part.width);
    for (const each of part.ids) each.visible = state.forces && length > 1e-6;
    along(shaft, from, force, part.width, Math.max(length - tip, 1e-9));
    along(head, add(from, unit(force), length - tip), force, 2.4 * part.width, Math.max(tip, 1e-9));
  }
}

// --- one picture

function draw() {
  const alone = state.mode > 0;
  const now = lookup(state.time);
  const [place, R] = alone ? [row3(array.position, 0), array.rotation.slice(0, 9)]
    : [values("position", now), values("rotation", now)];
  for (const part of parts) for (const each of part.ids) each.visible = !alone && state.legs;
  let q, scale = state.scale, largest = null;
  if (alone) {
    q = new Float64Array(meta.modes);
    largest = meta.modePeaks[state.mode - 1][state.colouring] ?? null;
    q[state.mode - 1] = Math.sin(2 * Math.PI * state.phase);
    scale = meta.shown / meta.modePeaks[state.mode - 1].magnitude;
  } else {
    q = meta.modes ? values("elastic", now) : new Float64Array(0);
    if (meta.swings.length) {
      scale = state.amplitude;
      largest = meta.swings[state.swing].peaks[state.colouring] ?? null;
    }
    drawLegs(now, R, meta.swings.length ? 1 : scale);
    drawForces(now, R, scale);
  }
  const bend = drawPlatform(place, R, q, scale, largest);
  K3D.render();
  tell(alone ? [bend] : [bend, array.leg_deformation ? values("leg_deformation", now) : []], largest);
  state.frames += 1;
  state.firstPicture ??= performance.now();
}

function tell(bends, largest) {
  let most = 0;
  for (const bend of bends) {
    for (let n = 0; n < bend.length; n += 3) most = Math.max(most, Math.hypot(bend[n], bend[n + 1], bend[n + 2]));
  }
  const alone = state.mode > 0;
  element("clock").textContent = alone
    ? `mode ${state.mode}: ${meta.frequencies[state.mode - 1]}`
    : `t = ${state.time.toFixed(meta.digits)} s`;
  element("largest").textContent = alone || !meta.bends ? "" : `largest deformation ${(1e3 * most).toFixed(2)} mm`;
  if (meta.swings.length) tellSwing();
  element("slider").value = state.time;
  const part = (state.time - meta.start) / (meta.end - meta.start || 1);
  for (const cursor of document.querySelectorAll(".cursor")) {
    const x = +cursor.dataset.low + part * (cursor.dataset.high - cursor.dataset.low);
    cursor.style.transform = `translateX(${100 * x}%)`;
  }
  legend(largest);
}

function legend(largest) {
  const of = meta.colourings[state.colouring];
  element("legend").hidden = state.colouring === "plain" || (of.high === 0 && !meta.swings.length);
  const { low, high } = range(largest), relative = largest !== null;
  const swing = meta.swings.length ? swingLegend(of) : null;
  const shown = (value) => (value * (swing?.factor ?? (relative ? 1 / largest : of.factor))).toPrecision(3);
  const words = of.words + (swing?.words ?? (relative ? ", relative" : ` (${of.units})`));
  const text = [shown(high), shown(low), words].join();
  if (legend.text === text) return;
  legend.text = text;
  element("legend-high").textContent = shown(high);
  element("legend-low").textContent = shown(low);
  element("legend-words").textContent = words;
  element("legend-bar").style.background = `linear-gradient(to top, ${of.colours.join(",")})`;
}

// --- controls

function control(id, event, change) {
  element(id)?.addEventListener(event, (e) => { change(e.target); draw(); });
}

function play(on) {
  state.playing = on;
  element("play").textContent = on ? "❚❚" : "▶";
  element("play").title = on ? "pause (space)" : "play (space)";
}

function go(time) {
  play(false);
  state.mode = 0;
  if (element("motion")) element("motion").value = "0";
  state.time = Math.min(meta.end, Math.max(meta.start, time));
  draw();
}

element("play").addEventListener("click", () => {
  if (!state.playing && state.time >= meta.end) state.time = meta.start;
  play(!state.playing);
});
element("slider").addEventListener("input", (e) => go(+e.target.value));
control("speed", "change", (at) => { state.speed = +at.value; });
control("scale", "input", (at) => { state.scale = meta.scales[+at.value]; sayScale(); });
control("colouring", "change", (at) => { state.colouring = at.value; });
control("motion", "change", (at) => { state.mode = +at.value; if (state.mode) play(true); });
control("amplitude", "input", (at) => { state.amplitude = +at.value; });
control("legs", "change", (at) => { state.legs = at.checked; });
control("forces", "change", (at) => { state.forces = at.checked; });
for (const curve of document.querySelectorAll(".curve")) {
  curve.addEventListener("click", (e) => {
    const cursor = curve.querySelector(".cursor");
    const x = (e.clientX - curve.getBoundingClientRect().left) / curve.clientWidth;
    const low = +cursor.dataset.low, high = +cursor.dataset.high;
    go(meta.start + (meta.end - meta.start) * (x - low) / (high - low));
  });
}
document.addEventListener("keydown", (e) => {
  if (["INPUT", "SELECT", "BUTTON"].includes(e.target.tagName) && e.target.id !== "slider") return;
  if (meta.swings.length && swingKey(e)) return;
  const step = { ArrowRight: 1, ArrowLeft: -1 }[e.key];
  if (step) { e.preventDefault(); go(array.time[Math.min(count - 1, Math.max(0, lookup(state.time).i + step))]); }
  if (e.key === " ") { e.preventDefault(); element("play").click(); }
});

function sayScale() {
  if (element("scale-shown")) element("scale-shown").textContent = `× ${+state.scale.toPrecision(3)}`;
}

// --- time goes on; moving, with as many pixels as the machine draws in time; at rest, with fine ones

const FINE = 2;
const pixels = { moving: Math.min(FINE, window.devicePixelRatio || 1), now: 0, pace: 0.02, still: 0 };

function resolution(ratio) {
  if (ratio === pixels.now) return;
  pixels.now = ratio;
  K3D.getWorld().renderer.setPixelRatio(ratio);
}

function moving() {
  pixels.still = performance.now() + 250;
  resolution(pixels.moving);
}

function keepPace(dt) {
  pixels.pace += 0.1 * (dt - pixels.pace);
  if (pixels.pace > 0.04 && pixels.moving > 0.5) {
    pixels.moving = Math.max(0.5, pixels.moving - 0.25);
    pixels.pace = 0.02;
  }
}

let last = performance.now();
function tick(now) {
  const dt = Math.min(0.25, (now - last) / 1000);
  last = now;
  if (state.playing) {
    keepPace(dt);
    moving();
    if (state.mode) state.phase += 0.5 * dt;
    else state.time += state.speed * dt;
    if (state.time > meta.end) state.time = meta.start;
    draw();
  } else if (pixels.now < FINE && now > pixels.still) {
    resolution(FINE);
    K3D.render();
  }
  requestAnimationFrame(tick);
}
for (const event of ["pointerdown", "pointermove", "wheel"]) {
  element("canvasTarget").addEventListener(event, (e) => { if (e.buttons || event === "wheel") moving(); }, true);
}

// --- the live page follows its file

async function follow(stamp) {
  const now = await fetch(meta.live).then((answer) => answer.text(), () => stamp);
  if (now !== stamp) location.reload();
  setTimeout(follow, 1500, now);
}

async function payload() {
  const meta = JSON.parse(document.getElementById("parflex-meta").textContent);
  const text = atob(document.getElementById("parflex-data").textContent.trim());
  const bytes = Uint8Array.from(text, (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  const buffer = await new Response(stream).arrayBuffer();
  const array = {};
  for (const [name, { offset, length }] of Object.entries(meta.arrays)) {
    array[name] = new Float32Array(buffer, offset, length);
  }
  return { meta, array };
}

// what tests, and scripts of one's own, may ask
window.parflex = { state, meta, array, plates, parts, go, play, draw, bending, choose, K3D };

// K3D draws at every part that it loads; until now onto next to nothing
element("canvasTarget").classList.add("ready");
K3D.resizeHelper();
moving();
sayScale();
if (meta.swings.length) listSwings();
play(state.playing);
draw();
element("loading").remove();
requestAnimationFrame(tick);
if (meta.live) follow(meta.stamp);