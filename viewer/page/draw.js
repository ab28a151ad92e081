// The picture at one time.

const ARROWS = { contact: "#b3402a", joint: "#8a6d00", load: "#c96a00" };
const FLEX = "#1f7a5c", TOUCH = "#b3402a", SPEED = "#1565c0", PAPER = "#fbfcfe";
const shows = { forces: true, joints: false, velocities: false, trails: true, names: true };
const chosen = new Map(scene.bands.map((band) => [band, 0]));

// Lengths of arrows: the usual one is an eighth of the scene.
const reach = { velocity: usual(speeds()) };
for (const kind of Object.keys(ARROWS)) {
  reach[kind] = usual(scene.arrows.filter((a) => a.kind === kind).flatMap((a) => sizes(a.vector.numbers)));
}

function sizes(numbers) {
  const found = [];
  for (let k = 0; k + 1 < numbers.length; k += 2) found.push(Math.hypot(numbers[k], numbers[k + 1]));
  return found;
}

function speeds() {
  return scene.frames.filter((f) => f.velocity).flatMap((f) => sizes(f.velocity.numbers));
}

function drawScene(g, time) {
  const where = place(time), u = 0.01 * scene.size * camera.scale;
  if (camera.follow) {
    const [x, y] = pose(camera.follow, where);
    camera.x = x;
    camera.y = y;
  }
  g.fillStyle = PAPER;
  g.fillRect(0, 0, camera.width, camera.height);
  g.lineJoin = g.lineCap = "round";
  drawGrid(g);
  if (shows.trails && !still) drawTrails(g, where);
  drawParts(g, 0, where, u);
  for (const band of scene.bands) drawBand(g, band, where, u);
  drawParts(g, 1, where, u);
  for (const line of scene.lines) drawLine(g, line, where, u);
  for (const link of scene.links) {
    drawLink(g, link.kind, toScreen(anchored(link.a, where)), toScreen(anchored(link.b, where)), u);
  }
  drawParts(g, 2, where, u);
  drawGauges(g, where);
  if (shows.names) drawNames(g, where);
  if (shows.velocities) drawVelocities(g, where);
  drawForces(g, where, time);
  drawScale(g);
}

function drawParts(g, layer, where, u) {
  for (const part of scene.parts) {
    if (part.layer !== layer) continue;
    const [x, y, angle] = pose(part.frame, where), c = Math.cos(angle), s = Math.sin(angle);
    for (const shape of part.shapes) {
      g.beginPath();
      if (shape.kind === "circle") {
        const [px, py] = toScreen([x + c * shape.centre[0] - s * shape.centre[1], y + s * shape.centre[0] + c * shape.centre[1]]);
        g.arc(px, py, Math.max(shape.radius * camera.scale, 1), 0, 2 * Math.PI);
      } else {
        shape.points.forEach(([a, b], k) => {
          const [px, py] = toScreen([x + c * a - s * b, y + s * a + c * b]);
          if (k) g.lineTo(px, py); else g.moveTo(px, py);
        });
        if (shape.closed) g.closePath();
      }
      if (shape.fill) {
        g.fillStyle = shape.fill;
        g.fill();
      }
      if (shape.stroke) {
        g.strokeStyle = shape.stroke;
        g.lineWidth = Math.max(shape.width * u, 0.8);
        g.setLineDash(shape.dashed ? [2 * u, 2 * u] : []);
        g.stroke();
        g.setLineDash([]);
      }
    }
  }
}

// A line rounded at its vertices: the quadratic pieces of `Line2D`.
function drawLine(g, line, where, u) {
  const p = line.nodes.map((node) => toScreen(anchored(node, where))), n = p.length, part = 0.5 * line.rounding;
  const mix = (a, b, x) => [a[0] + x * (b[0] - a[0]), a[1] + x * (b[1] - a[1])];
  g.beginPath();
  const vertices = line.closed ? [...p.keys()] : [...p.keys()].slice(1, -1);
  if (line.closed) g.moveTo(...mix(p[0], p[n - 1], part)); else g.moveTo(...p[0]);
  for (const k of vertices) {
    const before = p[(k + n - 1) % n], after = p[(k + 1) % n];
    g.lineTo(...mix(p[k], before, part));
    g.quadraticCurveTo(...p[k], ...mix(p[k], after, part));
  }
  if (line.closed) g.closePath(); else g.lineTo(...p[n - 1]);
  g.strokeStyle = TOUCH;
  g.lineWidth = Math.max(line.thickness * camera.scale, 0.6 * u, 1.5);
  g.stroke();
}

// Blue where negative, red where positive.
function colour(part) {
  const x = Math.max(-1, Math.min(1, part)), a = x < 0 ? [33, 84, 194] : [196, 38, 32], w = Math.abs(x) ** 0.7;
  const mixed = [205, 212, 220].map((v, k) => Math.round(v + w * (a[k] - v)));
  return `rgb(${mixed.join(",")})`;
}

function bandPoint(band, where, k) {
  const width = 2 * band.points.shape[1];
  return [at(band.points, where, width, 2 * k), at(band.points, where, width, 2 * k + 1)];
}

function drawBand(g, band, where, u) {
  const count = band.points.shape[1], thick = Math.max(band.width * u, 3), points = [];
  for (let k = 0; k < count; k++) points.push(toScreen(bandPoint(band, where, k)));
  g.lineCap = "butt";
  strokeLine(g, lengthened(points, 1.2), "#123f30", thick + 2.4);
  const field = band.fields[chosen.get(band)];
  if (!field) {
    strokeLine(g, points, FLEX, thick);
  } else {
    const values = [];
    for (let k = 0; k < count; k++) values.push(at(field.values, where, count, k));
    for (let k = 0; k + 1 < count; k++) {
      const piece = k + 2 < count ? [points[k], points[k + 1], nudge(points[k + 1], points[k + 2])] : [points[k], points[k + 1]];
      strokeLine(g, piece, colour((0.5 * (values[k] + values[k + 1])) / field.limit), thick);
    }
  }
  g.lineCap = "round";
}

// A little into the next piece: no gaps are seen between them.
function nudge(a, b) {
  const d = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
  return [a[0] + (0.7 * (b[0] - a[0])) / d, a[1] + (0.7 * (b[1] - a[1])) / d];
}

function lengthened(points, by) {
  const out = (a, b) => {
    const d = Math.hypot(a[0] - b[0], a[1] - b[1]) || 1;
    return [a[0] + (by * (a[0] - b[0])) / d, a[1] + (by * (a[1] - b[1])) / d];
  };
  const n = points.length;
  return [out(points[0], points[1]), ...points.slice(1, -1), out(points[n - 1], points[n - 2])];
}

function drawTrails(g, where) {
  const paths = scene.frames.filter((f) => f.velocity).map((f) => [f.motion, 3, 0]);
  for (const band of scene.bands) paths.push([band.points, 2 * band.points.shape[1], 2 * (band.points.shape[1] - 1)]);
  for (const [packed, width, index] of paths.slice(0, 24)) {
    const rows = packed.shape[0];
    if (rows < 2) continue;
    const point = (k) => toScreen([packed.numbers[k * width + index], packed.numbers[k * width + index + 1]]);
    const stride = Math.ceil(rows / 400);
    g.beginPath();
    for (let k = 0; k < rows; k += stride) {
      const [x, y] = point(k);
      if (k) g.lineTo(x, y); else g.moveTo(x, y);
    }
    g.strokeStyle = "#9fb2c855";
    g.lineWidth = 1;
    g.stroke();
    // the newest part, in pieces that fade
    const from = place(Math.max(first, times[where.k] - 0.12 * (last - first))).k, pieces = 24;
    const now = toScreen([at(packed, where, width, index), at(packed, where, width, index + 1)]);
    const each = Math.max(1, Math.ceil((where.k - from) / pieces));
    for (let k = from; k <= where.k; k += each) {
      const end = Math.min(k + each, where.k), points = [];
      for (let i = k; i <= end; i += Math.max(1, Math.floor(each / 4))) points.push(point(i));
      points.push(end === where.k ? now : point(end));
      const part = (k - from + each) / (where.k - from + each);
      strokeLine(g, points, `rgba(31,95,191,${(0.75 * part).toFixed(3)})`, 1 + 1.2 * part);
    }
  }
}

function drawNames(g, where) {
  const taken = [];
  // a name that would cover another one is left out
  const free = (text, x, y, middle) => {
    const wide = 7 * text.length, left = middle ? x - 0.5 * wide : x;
    if (taken.some((box) => left < box[1] && left + wide > box[0] && Math.abs(y - box[2]) < 13)) return false;
    taken.push([left, left + wide, y]);
    return true;
  };
  scene.frames.forEach((frame, k) => {
    if (!frame.label) return;
    const [x, y] = toScreen(anchored({ frame: k, point: frame.label }, where));
    const middle = !frame.label[0] && !frame.label[1];
    const from = middle ? x : x + 4;
    if (free(frame.name, from, y, middle)) drawText(g, frame.name, from, y, INK, middle ? "center" : "left");
  });
  for (const band of scene.bands) {
    const [x, y] = toScreen(bandPoint(band, where, band.points.shape[1] >> 1));
    drawText(g, band.name, x, y - 16, FLEX, "center");
  }
}

function arrowTip(from, x, y, usual) {
  const size = Math.hypot(x, y), length = Math.min(size / usual, 2.2) * 0.125 * scene.size;
  return size > 0 ? [from[0] + (length * x) / size, from[1] + (length * y) / size] : from;
}

function drawVelocities(g, where) {
  if (!reach.velocity) return;
  scene.frames.forEach((frame, k) => {
    if (!frame.velocity) return;
    const from = pose(k, where), x = at(frame.velocity, where, 2, 0), y = at(frame.velocity, where, 2, 1);
    const to = toScreen(arrowTip(from, x, y, reach.velocity));
    if (Math.hypot(x, y) < 0.004 * reach.velocity) return;
    drawArrow(g, toScreen(from), to, SPEED);
    if (scene.frames.length < 9) drawText(g, shown(Math.hypot(x, y), "m/s"), to[0] + 6, to[1] - 6, SPEED);
  });
}

// Contact forces end at the contact where they press, others begin where they act.
function drawForces(g, where, time) {
  for (const arrow of scene.arrows) {
    if (arrow.kind === "joint" ? !shows.joints : !shows.forces) continue;
    const from = [at(arrow.at, where, 2, 0), at(arrow.at, where, 2, 1)];
    const x = at(arrow.vector, where, 2, 0), y = at(arrow.vector, where, 2, 1), size = Math.hypot(x, y);
    if (arrow.kind === "contact") drawBlows(g, arrow, time);
    if (!(size > 1e-3 * reach[arrow.kind])) continue;
    const to = toScreen(arrowTip(from, x, y, reach[arrow.kind]));
    drawArrow(g, toScreen(from), to, ARROWS[arrow.kind]);
    if (scene.arrows.length < 13) drawText(g, shown(size, arrow.unit), to[0] + 7, to[1], ARROWS[arrow.kind]);
  }
}

// An impact of a constraint has no force but an impulse: a ring that fades for a third of a second of playing.
function drawBlows(g, arrow, time) {
  const fade = 0.35 * Math.max(state.speed, 1e-12);
  for (const event of blows.get(arrow.name) || []) {
    const age = (time - event.t) / fade;
    if (age < -1e-9 || age > 1) continue;
    const there = place(event.t);
    const [x, y] = toScreen([at(arrow.at, there, 2, 0), at(arrow.at, there, 2, 1)]), strength = 1 - Math.max(age, 0);
    g.beginPath();
    g.arc(x, y, 6 + 16 * (1 - strength), 0, 2 * Math.PI);
    g.strokeStyle = `rgba(179,64,42,${strength.toFixed(3)})`;
    g.lineWidth = 3 * strength + 0.5;
    g.stroke();
    drawText(g, shown(event.impulse, "N.s"), x + 12, y + 14, ARROWS.contact);
  }
}

function drawGrid(g) {
  const step = round(110 / camera.scale);
  g.lineWidth = 1;
  g.strokeStyle = "#e9edf2";
  g.beginPath();
  const x0 = camera.x - (0.5 * camera.width) / camera.scale, y0 = camera.y - (0.5 * camera.height) / camera.scale;
  for (let k = Math.ceil(x0 / step); toScreen([k * step, 0])[0] < camera.width; k++) {
    const x = Math.round(toScreen([k * step, 0])[0]) + 0.5;
    g.moveTo(x, 0);
    g.lineTo(x, camera.height);
  }
  for (let k = Math.ceil(y0 / step); toScreen([0, k * step])[1] > 0; k++) {
    const y = Math.round(toScreen([0, k * step])[1]) + 0.5;
    g.moveTo(0, y);
    g.lineTo(camera.width, y);
  }
  g.stroke();
}

function drawScale(g) {
  const length = round(130 / camera.scale), wide = length * camera.scale, y = camera.height - 16;
  strokeLine(g, [[12, y - 4], [12, y], [12 + wide, y], [12 + wide, y - 4]], "#6b7280", 1.4);
  drawText(g, shown(length, "m"), 18 + wide, y - 2, "#6b7280");
}

// Coordinates without a place in the plane: pointers on scales of their own, in the middle if there is nothing else.
function drawGauges(g, where) {
  const count = Math.min(scene.gauges.length, Math.floor((camera.width - 20) / 110));
  if (!count) return;
  const alone = scene.frames.length < 2 && !scene.bands.length;
  const high = alone ? Math.max(80, camera.height - 230) : 90, top = alone ? 130 : camera.height - 150;
  const step = Math.min(130, (camera.width - 40) / count), left = alone ? 0.5 * (camera.width - step * count) : 10;
  scene.gauges.slice(0, count).forEach((gauge, k) => {
    const x = left + (k + 0.45) * step, n = gauge.values.numbers;
    let low = Infinity, up = -Infinity;
    for (const v of n) { if (v < low) low = v; if (v > up) up = v; }
    if (!(up - low > 1e-12 * Math.max(Math.abs(up), Math.abs(low)))) [low, up] = [low - 1, up + 1];
    const y = (v) => top + high * (1 - (v - low) / (up - low)), value = at(gauge.values, where, 1, 0);
    strokeLine(g, [[x, top], [x, top + high]], "#c5ccd6", 6);
    if (low < 0 && up > 0) strokeLine(g, [[x - 10, y(0)], [x + 10, y(0)]], "#6b7280", 1);
    strokeLine(g, [[x - 13, y(value)], [x + 13, y(value)]], FLEX, 5);
    drawText(g, gauge.name, x, top - 30, INK, "center");
    drawText(g, shown(value, gauge.unit), x, top - 14, FLEX, "center");
  });
}
