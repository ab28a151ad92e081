// How space is seen: from where, and what part of it. A parallel projection, so that lengths can be compared.

const camera = { target: [0, 0, 0], turn: 0.25 * Math.PI, rise: 0.6155, scale: 1, width: 1, height: 1, moved: false, follow: 0 };
const CORNER = [0.25 * Math.PI, 0.6155];
const [RIGHT_AXIS, UP_AXIS, TOWARDS_AXIS] = scene.eye;

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const sum = (a, b, by) => a.map((x, k) => x + by * b[k]);

// From the model's axes to those of glTF, where y points up, and back.
const upright = (p) => [dot(RIGHT_AXIS, p), dot(UP_AXIS, p), dot(TOWARDS_AXIS, p)];
const modelled = (p) => [0, 1, 2].map((k) => p[0] * RIGHT_AXIS[k] + p[1] * UP_AXIS[k] + p[2] * TOWARDS_AXIS[k]);

// Right, up and towards the reader, in glTF's axes.
function eyeAxes() {
  const c = Math.cos(camera.turn), s = Math.sin(camera.turn), h = Math.cos(camera.rise), v = Math.sin(camera.rise);
  return [[c, 0, -s], [-v * s, h, -v * c], [h * s, v, h * c]];
}

function onPaper(p) {
  const [right, up] = eyeAxes(), x = sum(upright(p), upright(camera.target), -1);
  return [dot(right, x), dot(up, x)];
}

function toScreen(p) {
  const [x, y] = onPaper(p);
  return [0.5 * camera.width + x * camera.scale, 0.5 * camera.height - y * camera.scale];
}

function fit() {
  const n = scene.corners.numbers, seen = [];
  for (let k = 0; k + 2 < n.length; k += 3) seen.push(onPaper([n[k], n[k + 1], n[k + 2]]));
  const xs = seen.map((p) => p[0]), ys = seen.map((p) => p[1]), least = 0.25 * scene.size;
  const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  const margin = { x: 34, top: camera.width < 600 ? 126 : 56, bottom: 50 };
  camera.scale = Math.min((camera.width - 2 * margin.x) / Math.max(x1 - x0, least), (camera.height - margin.top - margin.bottom) / Math.max(y1 - y0, least));
  camera.scale = Math.max(camera.scale, 1e-9);
  shift(0.5 * (x0 + x1), 0.5 * (y0 + y1) + (0.5 * (margin.top - margin.bottom)) / camera.scale);
  camera.moved = false;
}

// Moves what is in the middle, along the picture, m.
function shift(x, y) {
  const [right, up] = eyeAxes();
  camera.target = sum(sum(camera.target, modelled(right), x), modelled(up), y);
}

function zoomAt(px, py, factor) {
  const x = (px - 0.5 * camera.width) / camera.scale, y = (0.5 * camera.height - py) / camera.scale;
  camera.scale *= factor;
  shift(x - x / factor, y - y / factor);
  camera.moved = true;
}

function pan(dx, dy) {
  shift(-dx / camera.scale, dy / camera.scale);
  camera.moved = true;
}

function turnView(dx, dy) {
  camera.turn -= 0.008 * dx;
  camera.rise = Math.max(-0.5 * Math.PI, Math.min(0.5 * Math.PI, camera.rise + 0.008 * dy));
  document.getElementById("side").value = "";
}

// Seen along one of the model's axes, or from a corner.
function lookAlong(name) {
  const k = "xyz".indexOf(name), d = upright([0, 1, 2].map((i) => (i === k ? 1 : 0)));
  [camera.turn, camera.rise] = k < 0 ? CORNER : [Math.abs(d[1]) > 0.5 ? 0 : Math.atan2(d[0], d[2]), Math.asin(d[1])];
  fit();
}

// Mouse, pen and fingers: one turns, two move and zoom; with shift or another button the mouse moves.
function watchView(canvas, changed) {
  const pointers = new Map();
  const middle = () => {
    const all = [...pointers.values()];
    const x = all.reduce((s, p) => s + p.x, 0) / all.length, y = all.reduce((s, p) => s + p.y, 0) / all.length;
    return { x, y, spread: all.length > 1 ? Math.hypot(all[0].x - all[1].x, all[0].y - all[1].y) : 0 };
  };
  const local = (event) => {
    const box = canvas.getBoundingClientRect();
    return { x: event.clientX - box.left, y: event.clientY - box.top };
  };
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, local(event));
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!pointers.has(event.pointerId)) return;
    const old = middle();
    pointers.set(event.pointerId, local(event));
    const now = middle(), moves = pointers.size > 1 || event.shiftKey || event.buttons > 1;
    (moves ? pan : turnView)(now.x - old.x, now.y - old.y);
    if (old.spread > 0 && now.spread > 0) zoomAt(now.x, now.y, now.spread / old.spread);
    changed();
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (e) => pointers.delete(e.pointerId));
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const p = local(event);
    zoomAt(p.x, p.y, Math.exp(-0.0015 * event.deltaY));
    changed();
  }, { passive: false });
  canvas.addEventListener("dblclick", () => { fit(); changed(); });
}

// The list of sides to look from.
function sideSelect() {
  const select = document.createElement("select");
  select.id = "side";
  select.title = "From where it is seen";
  select.setAttribute("aria-label", "From where it is seen");
  for (const [text, value] of [["from a corner", "corner"], ["along x", "x"], ["along y", "y"], ["along z", "z"], ["turned", ""]]) select.add(new Option(text, value));
  select.options[4].hidden = true;
  select.addEventListener("change", () => { lookAlong(select.value); redraw(); });
  return select;
}
